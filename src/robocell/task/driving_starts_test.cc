#include "robocell/task/driving_starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <Eigen/Core>

#include "robocell/motion/clearance.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/types.h"
#include "robocell/task/testing/driving_runs.h"

namespace robocell::internal {
namespace {

double Away(const EpisodeStart& start, const Robot& robot) {
  const std::string& body = start.scene.compiled()->object(start.target_object).root_body;
  return (start.scene.body_pose(body).translation() - robot.base().pose().translation())
      .head<2>()
      .norm();
}

TEST(DrivingStarts, AreAnywhereOnTheFloorUnlessADistanceIsStated) {
  RunConfig run = PicksFromTheTable();
  double farthest = 0;
  for (const int seed : {1, 2}) {
    DrivingStartSampler sampler(run);
    const EpisodeStart start = StartOf(sampler, seed);
    const Robot robot = Robot::Of(start.scene, run.robot.config.name);
    farthest = std::max(farthest, Away(start, robot));
    EXPECT_GT(RobotClearance(start.scene, robot, 0.1).distance, 0.03);
  }
  EXPECT_GT(farthest, 1);
  run.start.base_distance = Vec2{0.45, 0.7};
  DrivingStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 1);
  EXPECT_LT(Away(start, Robot::Of(start.scene, run.robot.config.name)), 0.71);
}

// Cameras are where the robot begins, not where it works.
TEST(DrivingStarts, HaveCamerasThatSeeTheRobotWhereItBegins) {
  RunConfig run = PicksFromTheTable();
  run.cameras.streams.push_back({.name = "side", .camera = "side"});
  run.start.cameras["side"] = {.around = {"gripper"},
                               .distance = {0.4, 0.6},
                               .height = {0.2, 0.4},
                               .sees = {{"gripper", {.pixels = 20}}}};
  double farthest = 0;
  for (const int seed : {1, 2}) {
    DrivingStartSampler sampler(run);
    const EpisodeStart start = StartOf(sampler, seed);
    const Robot robot = Robot::Of(start.scene, run.robot.config.name);
    farthest = std::max(farthest, Away(start, robot));
    const Eigen::Vector3d camera = start.scene.camera_pose("side").translation();
    EXPECT_LT((camera - robot.tcp_in_world().translation()).norm(), 0.8) << seed;
  }
  EXPECT_GT(farthest, 1);
}

TEST(DrivingStarts, AreOfRobotsThatDrive) {
  const auto drives = [](const RunConfig& run) {
    return std::dynamic_pointer_cast<DrivingStartSampler>(MakeSamplerOfWork(run)) != nullptr;
  };
  RunConfig run = PicksFromTheTable();
  EXPECT_TRUE(drives(run));
  run.robot.config.base.kind = BaseKind::kMocap;
  EXPECT_FALSE(drives(run));
}

}  // namespace
}  // namespace robocell::internal
