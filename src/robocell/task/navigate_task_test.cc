#include "robocell/task/navigate_task.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/navigate_kind.h"
#include "robocell/task/testing/driving_runs.h"

namespace robocell::internal {
namespace {

// Near, facing and at rest, each alone is not enough.
TEST(NavigateTask, IsDoneByARobotThatStandsNearTheObjectAndFacesIt) {
  const RunConfig run = DrivesToTheTable();
  FloorStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 1);
  Scene scene = start.scene;
  const Robot robot = Robot::Of(scene, run.robot.config.name);
  Task& task = *start.task;
  EXPECT_EQ(task.instruction(), "go to the table");
  task.Begin(scene);
  const TaskVerdict before = task.Judge(scene);
  EXPECT_FALSE(before.success);
  EXPECT_EQ(before.subtask, 0);
  FloorWays ways(robot);
  const int table = RequireId(scene.model(), mjOBJ_BODY, "table", "scene");
  const std::vector<FloorPlace> places =
      ways.PlacesBeside(FootprintOf(scene, table), 0.55, nullptr);
  ASSERT_FALSE(places.empty());
  const double height = robot.base().pose().translation().z();
  const auto judge = [&](const FloorPlace& place) {
    robot.base().SetPose(PoseOf(place, height));
    scene.Forward();
    return task.Judge(scene);
  };
  const FloorPlace there = places.front();
  EXPECT_TRUE(judge(there).success);
  EXPECT_EQ(judge(there).progress, 1);
  EXPECT_EQ(judge(there).subtask, 1);
  EXPECT_FALSE(judge({there.x, there.y, there.yaw + 1}).success);
  EXPECT_EQ(judge({there.x, there.y, there.yaw + 1}).subtask, 1);
  EXPECT_FALSE(
      judge({there.x - 2 * std::cos(there.yaw), there.y - 2 * std::sin(there.yaw), there.yaw})
          .success);
  EXPECT_TRUE(judge(there).success);
  robot.base().SetJointVel(std::vector<double>{0.2, 0, 0});
  EXPECT_FALSE(task.Judge(scene).success);
}

}  // namespace
}  // namespace robocell::internal
