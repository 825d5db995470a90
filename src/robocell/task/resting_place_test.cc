#include "robocell/task/resting_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// A cube on the floor, and a table of 0.4 m with its middle in (1, 0).
Scene TableRoom() {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(BoxObject("cube", {0, 0, 0.02}));
  SceneObject table = BoxObject("table", {1, 0, 0.2});
  table.size = Vec3{0.2, 0.2, 0.2};
  table.fixed = true;
  spec.objects.push_back(table);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

std::string WhyNoRestAt(const Eigen::Vector3d& at) {
  const Scene scene = TableRoom();
  const int cube = FindId(scene.model(), mjOBJ_BODY, "cube");
  const RestPlace place{.frame = 0, .at = at};
  return WhyNoRest(scene, cube, {&place, 1}, 0.03);
}

TEST(RestingPlace, AnObjectRestsOnTheFloorAndOnATable) {
  EXPECT_EQ(WhyNoRestAt({0.4, 0.2, 0.02}), "");
  EXPECT_EQ(WhyNoRestAt({1, 0, 0.42}), "");
}

TEST(RestingPlace, AnObjectDoesNotRestInTheAirOrInsideOfATable) {
  EXPECT_NE(WhyNoRestAt({0.4, 0.2, 0.5}), "");
  EXPECT_THAT(WhyNoRestAt({1, 0, 0.2}), HasSubstr("table"));
}

TEST(RestingPlace, HeightsAreMeasuredFromTheSupport) {
  const Scene scene = TableRoom();
  const int cube = FindId(scene.model(), mjOBJ_BODY, "cube");
  EXPECT_NEAR(HeightOverSupport(scene, {0.5, 0.5, 0.3}, cube), 0.3, 1e-6);
  EXPECT_NEAR(HeightOverSupport(scene, {1, 0, 0.5}, cube), 0.1, 1e-6);
  EXPECT_LT(HeightOverSupport(scene, {1, 0, 0.3}, cube), 0) << "inside of the table";
  EXPECT_NEAR(HeightOverSupport(scene, {0, 0, 0.3}, cube), 0.3, 1e-6) << "the cube is left out";
}

}  // namespace
}  // namespace robocell::internal
