#include "robocell/task/navigate_task.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/types.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/navigate_kind.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/testing/driving_runs.h"
#include "robocell/testing/expect_throw.h"

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

// A category stands for each of its rooms.
TEST(NavigateTask, AnyRoomOfTheCategoryWillDo) {
  const RunConfig run = DrivesToTheTable();
  FloorStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 1);
  const Robot robot = Robot::Of(start.scene, run.robot.config.name);
  const Eigen::Vector3d at = robot.base().pose().translation();
  const auto around = [&](double x) {
    return std::vector<Vec2>{{x - 0.5, at.y() - 0.5},
                             {x + 0.5, at.y() - 0.5},
                             {x + 0.5, at.y() + 0.5},
                             {x - 0.5, at.y() + 0.5}};
  };
  SceneAnnotations known;
  known.rooms = {{.name = "room_1", .category = "bedroom", .outline = around(at.x() + 5)},
                 {.name = "room_2", .category = "bedroom", .outline = around(at.x())}};
  const auto task_to = [&](const std::string& to) {
    NavigateTaskConfig fields;
    fields.to = to;
    auto task = std::make_shared<NavigateTask>(fields);
    SceneSpec spec;
    Rng rng = Rng::Stream(1, "task");
    TaskCalls(*task).Prepare([&] { return std::make_shared<const SceneAnnotations>(known); }, spec,
                             rng, "navigate");
    task->Bind(start.scene, {.place = "test", .robots = {robot.name()}});
    task->Begin(start.scene);
    return task;
  };
  EXPECT_EQ(task_to("bedroom")->instruction(), "go to the bedroom");
  EXPECT_TRUE(task_to("bedroom")->Judge(start.scene).success);
  EXPECT_TRUE(task_to("room_2")->Judge(start.scene).success);
  EXPECT_FALSE(task_to("room_1")->Judge(start.scene).success);
  ExpectThrow<NotFoundError>([&] { task_to("bedrom"); }, "Did you mean 'bedroom'?");
  const auto task = task_to("bedroom");
  EXPECT_EQ(task->WhyNotRecalled(task->memory()), "");
  EXPECT_EQ(task->WhyNotRecalled(std::vector<double>{1, 0}),
            "number 0, where the robot goes, is 1; it is a whole number from 0 to 0");
  EXPECT_NE(task->WhyNotRecalled(std::vector<double>{0, std::nan("")}), "");
}

}  // namespace
}  // namespace robocell::internal
