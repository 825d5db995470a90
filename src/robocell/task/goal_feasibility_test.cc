#include "robocell/task/goal_feasibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// A cube on the floor, and a table of 0.4 m with its middle in (1, 0).
Scene Room(bool with_robot = false) {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(BoxObject("cube", {0, 0, 0.02}));
  SceneObject table = BoxObject("table", {1, 0, 0.2});
  table.size = Vec3{0.2, 0.2, 0.2};
  table.fixed = true;
  spec.objects.push_back(table);
  if (with_robot) {
    spec.robots.push_back({.name = "arm", .config = Rc7(), .prefix = "arm_", .base = BaseConfig{}});
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

std::string WhyNoRestAt(const Eigen::Vector3d& at) {
  const Scene scene = Room();
  const int cube = FindId(scene.model(), mjOBJ_BODY, "cube");
  const RestPlace place{.frame = 0, .at = at};
  return WhyNoRest(scene, cube, {&place, 1}, 0.03);
}

TEST(GoalFeasibility, AnObjectRestsOnTheFloorAndOnATable) {
  EXPECT_EQ(WhyNoRestAt({0.4, 0.2, 0.02}), "");
  EXPECT_EQ(WhyNoRestAt({1, 0, 0.42}), "");
}

TEST(GoalFeasibility, AnObjectDoesNotRestInTheAirOrInsideOfATable) {
  EXPECT_NE(WhyNoRestAt({0.4, 0.2, 0.5}), "");
  EXPECT_THAT(WhyNoRestAt({1, 0, 0.2}), HasSubstr("table"));
}

// The bound is that of the stretched arm: what it reaches at all is within it.
TEST(GoalFeasibility, OutOfReachMeansBeyondTheLengthOfTheArm) {
  const Scene scene = Room(true);
  const Robot arm = Robot::Of(scene, "arm");
  const double anywhere = -std::numeric_limits<double>::infinity();
  const Eigen::Vector3d base = arm.base_in_world().translation();
  EXPECT_EQ(WhyOutOfReach({arm}, arm.tcp_in_world().translation(), anywhere, 0), "");
  EXPECT_EQ(WhyOutOfReach({arm}, base + Eigen::Vector3d(0.4, 0, 0.3), anywhere, 0), "");
  const Eigen::Vector3d far = base + Eigen::Vector3d(2 * arm.reach() + 1, 0, 0);
  EXPECT_NE(WhyOutOfReach({arm}, far, anywhere, 0), "");
  EXPECT_EQ(WhyOutOfReach({arm}, far, anywhere, 2 * arm.reach() + 2), "") << "within the slack";
}

TEST(GoalFeasibility, HeightsAreMeasuredFromTheSupport) {
  const Scene scene = Room();
  const int cube = FindId(scene.model(), mjOBJ_BODY, "cube");
  EXPECT_NEAR(HeightOverSupport(scene, {0.5, 0.5, 0.3}, cube), 0.3, 1e-6);
  EXPECT_NEAR(HeightOverSupport(scene, {1, 0, 0.5}, cube), 0.1, 1e-6);
  EXPECT_LT(HeightOverSupport(scene, {1, 0, 0.3}, cube), 0) << "inside of the table";
  EXPECT_NEAR(HeightOverSupport(scene, {0, 0, 0.3}, cube), 0.3, 1e-6) << "the cube is left out";
}

TEST(GoalFeasibility, TheRadiusOfABoxIsThatOfItsCorner) {
  const Scene scene = Room();
  const double radius = RadiusOf(scene.model(), FindId(scene.model(), mjOBJ_BODY, "cube"));
  EXPECT_NEAR(radius, 0.02 * std::sqrt(3), 1e-6);
}

}  // namespace
}  // namespace robocell::internal
