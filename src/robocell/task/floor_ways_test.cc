#include "robocell/task/floor_ways.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/motion/clearance.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/task/navigate_kind.h"
#include "robocell/task/testing/driving_runs.h"

namespace robocell::internal {
namespace {

TEST(FloorWays, ARoomIsWhatItsOutlineEncloses) {
  const Room room{.name = "l", .outline = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}}};
  EXPECT_TRUE(IsInRoom(room, {1, 3}));
  EXPECT_TRUE(IsInRoom(room, {3, 1}));
  EXPECT_FALSE(IsInRoom(room, {3, 3}));
  EXPECT_FALSE(IsInRoom(room, {-1, 1}));
}

TEST(FloorWays, PlacesComeBackFromPoses) {
  const FloorPlace place{1, -2, 2.5};
  const FloorPlace back = PlaceOf(PoseOf(place, 0.3));
  EXPECT_NEAR(back.x, 1, 1e-12);
  EXPECT_NEAR(back.y, -2, 1e-12);
  EXPECT_NEAR(back.yaw, 2.5, 1e-12);
}

TEST(FloorWays, PlacesBesideTheTableAreFreeAndFaceIt) {
  const RunConfig run = DrivesToTheTable();
  FloorStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 2);
  Scene scene = start.scene;
  const Robot robot = Robot::Of(scene, run.robot.config.name);
  FloorWays ways(robot);
  const Eigen::AlignedBox2d area =
      FootprintOf(scene, RequireId(scene.model(), mjOBJ_BODY, "table", "scene"));
  const std::vector<FloorPlace> places = ways.PlacesBeside(area, 0.6, nullptr);
  ASSERT_FALSE(places.empty());
  const auto way = ways.FindWay(places);
  ASSERT_TRUE(way);
  EXPECT_GT(LengthOf(*way), 0.5);
  const double height = robot.base().pose().translation().z();
  for (size_t i = 0; i < places.size(); i += 5) {
    const FloorPlace& place = places[i];
    EXPECT_LT(area.exteriorDistance(Eigen::Vector2d(place.x, place.y)), 0.6);
    const Eigen::Vector2d ahead = area.center() - Eigen::Vector2d(place.x, place.y);
    EXPECT_NEAR(std::remainder(std::atan2(ahead.y(), ahead.x()) - place.yaw, 2 * M_PI), 0, 1e-6);
    robot.base().SetPose(PoseOf(place, height));
    scene.Forward();
    EXPECT_GT(RobotClearance(scene, robot, 0.1).distance, 0.9 * kWayClearance);
  }
}

}  // namespace
}  // namespace robocell::internal
