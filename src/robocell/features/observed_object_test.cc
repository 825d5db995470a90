#include "robocell/features/observed_object.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

Scene TwoBoxes() {
  SceneSpec spec{.name = "lab", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  for (const double x : {1, 2}) {
    spec.objects.push_back({.name = x == 1 ? "near" : "far",
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0.5, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{0.8, 0.02, 0.001},
                            .pos = Vec3{x, 0, 1}});
  }
  return Scene::Build(spec);
}

TEST(ObservedObject, IsTheObjectOfItsNameByDefault) {
  const Scene scene = TwoBoxes();
  EXPECT_EQ(ObservedObject(scene, "far").pose_in_world().translation().x(), 2);
  ExpectThrow<NotFoundError>([&] { ObservedObject(scene, "fat"); }, "far");
}

TEST(ObservedObject, FollowsTheObjectThatItsNameStandsFor) {
  const Scene scene = TwoBoxes();
  std::string drawn = "near";
  ObservedObject target(scene, "target", [&](const Scene&, const std::string& name) {
    EXPECT_EQ(name, "target");
    return drawn;
  });
  EXPECT_EQ(target.pose_in_world().translation().x(), 1);
  drawn = "far";
  EXPECT_EQ(target.pose_in_world().translation().x(), 2);
  EXPECT_EQ(target.name(), "target");
  drawn = "gone";
  ExpectThrow<NotFoundError>([&] { target.pose_in_world(); }, "gone");
  drawn = "near";
  EXPECT_EQ(target.pose_in_world().translation().x(), 1);
}

}  // namespace
}  // namespace robocell
