#include "robocell/task/work_stances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/driving_starts.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/testing/driving_runs.h"

namespace robocell::internal {
namespace {

// What batched inverse kinematics promises, the check of grasps finds from there.
TEST(WorkStances, HaveGraspsInReach) {
  const RunConfig run = PicksFromTheTable();
  DrivingStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 3);
  Scene scene = start.scene;
  const Robot robot = Robot::Of(scene, run.robot.config.name);
  const std::string& body = scene.compiled()->object(start.target_object).root_body;
  const std::vector<WorkStance> stances = FindWorkStances(robot, body);
  ASSERT_GE(stances.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(stances, std::ranges::greater(), &WorkStance::grasps));
  int in_reach = 0;
  for (size_t i = 0; i < 5; ++i) {
    robot.base().SetPose(PoseOf(stances[i].base, robot.base().pose().translation().z()));
    scene.Forward();
    in_reach += !GraspCheck().Check(scene, robot, body, 0.05).has_value();
  }
  EXPECT_GE(in_reach, 4);
}

TEST(WorkStances, DistancesInReachEndWhereTheArmDoes) {
  const RunConfig run = PicksFromTheTable();
  DrivingStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 3);
  const Robot robot = Robot::Of(start.scene, run.robot.config.name);
  const Eigen::Vector3d shoulder(0, 0, robot.base().pose().translation().z() + 0.8);
  const auto level = DistancesInReach(robot, shoulder);
  ASSERT_TRUE(level);
  EXPECT_GT((*level)[1], 0.6);
  EXPECT_LT((*level)[1], robot.reach());
  const auto high = DistancesInReach(robot, shoulder + Eigen::Vector3d(0, 0, 0.5));
  ASSERT_TRUE(high);
  EXPECT_LT((*high)[1], (*level)[1]);
  EXPECT_FALSE(DistancesInReach(robot, shoulder + Eigen::Vector3d(0, 0, 2)));
}

TEST(DrawOnFloor, KeepsToTheFloorOfTheHeight) {
  const std::vector<FloorArea> floor = {
      {.frame_to_world = Pose(Eigen::Vector3d(1, 2, 0)), .half_x = 0.5, .half_y = 0.25},
      {.frame_to_world = Pose(Eigen::Vector3d(0, 0, 2.6)), .half_x = 5, .half_y = 5}};
  Rng rng = Rng::Stream(1, "floor");
  const std::vector<Pose> poses = DrawOnFloor(floor, 0, 20, rng);
  ASSERT_EQ(poses.size(), 20U);
  for (const Pose& pose : poses) {
    EXPECT_LE(std::abs(pose.translation().x() - 1), 0.5);
    EXPECT_LE(std::abs(pose.translation().y() - 2), 0.25);
    EXPECT_EQ(pose.translation().z(), 0);
  }
  EXPECT_TRUE(DrawOnFloor(floor, 1, 20, rng).empty());
}

}  // namespace
}  // namespace robocell::internal
