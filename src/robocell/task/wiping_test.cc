// Tests the judge of wiping without a robot: a block is put over the area and pressed on the floor by
// its poses.
#include "robocell/task/wiping.h"

#include <gtest/gtest.h>

#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held.h"
#include "robocell/task/held_relation.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr double kHalfHeight = 0.03, kPressed = 2e-4;  // m

class WipingTest : public ::testing::Test {
 protected:
  Scene Make(Rng& rng) {
    internal::RegisterTaskRelations();
    SceneSpec spec = EmptyScene();
    SceneObject block = BoxObject("block", {0, 0, 1});
    block.size = Vec3{rng.Uniform(0.015, 0.04), rng.Uniform(0.015, 0.04), kHalfHeight};
    spec.objects.push_back(block);
    spec.objects.push_back({.name = "area", .mjcf_path = "wiping_area", .pos = Vec3{0, 0, 0.001}});
    Scene scene = Scene::Build(spec);
    scene.Reset();
    scene.SetBodyPose(
        "area_wiping_area",
        Pose::FromRpy({rng.Uniform(-1, 1), rng.Uniform(-1, 1), 0.001}, {0, 0, rng.Uniform(-3, 3)}));
    scene.Forward();
    return scene;
  }
  // Drags the block along a path, at a height over the floor.
  static void Drag(Scene& scene, BoundRelation& wiped, const internal::HeldPath& path,
                   double height, double share = 1) {
    for (size_t i = 0; i < static_cast<size_t>(share * static_cast<double>(path.size())); ++i) {
      Eigen::Vector3d at = path[i].translation();
      at.z() = kHalfHeight + height;
      scene.SetBodyPose("block", Pose(at, path[i].quaternion()));
      scene.Forward();
      wiped.Watch();
    }
  }
};

TEST_F(WipingTest, CountsCellsUnderABlockThatPresses) {
  Rng rng = Rng::Stream(0, "wiping");
  for (int i = 0; i < 2; ++i) {
    Scene scene = Make(rng);
    const StatedRelation stated = ParseRelation("block wiped area 0.8");
    const auto wiped = BindRelation(scene, stated);
    for (const internal::HeldPath& path :
         internal::WipePaths(scene, stated, scene.body_pose("block"))) {
      wiped->Recall(std::vector<double>(wiped->memory().size(), 0));
      Drag(scene, *wiped, path, 0.002);
      EXPECT_EQ(wiped->Progress(), 0) << "it does not press";
      Drag(scene, *wiped, path, -kPressed, 0.3);
      const double some = wiped->Progress();
      EXPECT_GT(some, 0);
      EXPECT_FALSE(wiped->Holds());
      const std::vector<double> memory = wiped->memory();
      Drag(scene, *wiped, path, -kPressed);
      EXPECT_TRUE(wiped->Holds()) << wiped->Progress();
      EXPECT_GT(wiped->Progress(), 0.95) << "the lanes cover the area";
      wiped->Recall(memory);
      EXPECT_EQ(wiped->Progress(), some);
    }
  }
}

TEST_F(WipingTest, SaysWhatIsNoRegion) {
  Rng rng = Rng::Stream(0, "wiping");
  const Scene scene = Make(rng);
  ExpectThrow<NotFoundError>([&] { BindRelation(scene, ParseRelation("block wiped aera")); },
                             "Did you mean 'area'");
}

}  // namespace
}  // namespace robocell
