// Tests that robots on planar bases drive to where their work is in reach, and do it there.
#include "robocell/expert/drive_then.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/task/driving_starts.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/work_stances.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

RunConfig PicksFromTheTable() {
  RunConfig run = ExampleRun("mobile/pick.yaml");
  run.scenes = SceneSourceSpec("tabletop");
  run.cameras.streams.clear();
  PickTaskConfig task;
  task.objects = {"box"};
  run.task = TaskSpec(task);
  return run;
}

EpisodeStart StartOf(const RunConfig& run, int seed) {
  DrivingStartSampler sampler(run);
  std::string why;
  for (int attempt = 0; attempt < 20; ++attempt) {
    Rng rng = Rng::Stream(seed, "work", attempt);
    SampleResult sample = sampler.Sample({.episode = seed, .attempt = attempt}, rng);
    if (sample.start) return *std::move(sample.start);
    why += sample.refusal.reason + ": " + sample.refusal.detail + "\n";
  }
  throw Error("no start: " + why);
}

double Away(const EpisodeStart& start, const Robot& robot) {
  const std::string& body = start.scene.compiled()->object(start.target_object).root_body;
  return (start.scene.body_pose(body).translation() - robot.base().pose().translation())
      .head<2>()
      .norm();
}

TEST(DriveThen, DrivesToTheObjectAndPicksIt) {
  const RunConfig run = PicksFromTheTable();
  EpisodeStart start = StartOf(run, 2);
  Scene scene = start.scene;
  Robot robot = Robot::Of(scene, run.robot.config.name);
  start.task->Begin(scene);
  const std::shared_ptr<Expert> expert = FindExpertKind("pick")->Make(run, start);
  Rng rng = Rng::Stream(1, "expert");
  expert->Begin(scene, rng);
  ASSERT_EQ(expert->failure(), "");
  std::vector<std::string> phases;
  bool was_done = false;
  for (int row = 0; row < run.rates.max_steps && !expert->done(); ++row) {
    const Action action = expert->Act(scene, rng);
    const std::string phase = expert->phase_names()[static_cast<size_t>(expert->phase())];
    if (phases.empty() || phases.back() != phase) phases.push_back(phase);
    if (action.contains(robot.name())) {
      ASSERT_TRUE(robot.Apply(action.at(robot.name())).ok);
    }
    for (int i = 0; i < run.rates.control_ticks() * run.rates.sim_steps(); ++i) {
      robot.Update();
      ASSERT_TRUE(scene.Step().ok());
    }
    was_done = start.task->Judge(scene).success;
  }
  EXPECT_EQ(expert->failure(), "");
  EXPECT_TRUE(was_done);
  for (const char* phase : {"drive", "settle", "grasp", "lift", "done"})
    EXPECT_TRUE(std::ranges::find(phases, phase) != phases.end()) << phase;
}

// What batched inverse kinematics promises, the check of grasps finds from there.
TEST(WorkStances, HaveGraspsInReach) {
  const RunConfig run = PicksFromTheTable();
  const EpisodeStart start = StartOf(run, 3);
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

TEST(DrivingStarts, AreAnywhereOnTheFloorUnlessADistanceIsStated) {
  RunConfig run = PicksFromTheTable();
  double farthest = 0;
  for (const int seed : {1, 2}) {
    const EpisodeStart start = StartOf(run, seed);
    farthest = std::max(farthest, Away(start, Robot::Of(start.scene, run.robot.config.name)));
  }
  EXPECT_GT(farthest, 1);
  run.start.base_distance = Vec2{0.45, 0.7};
  const EpisodeStart start = StartOf(run, 1);
  EXPECT_LT(Away(start, Robot::Of(start.scene, run.robot.config.name)), 0.71);
}

}  // namespace
}  // namespace robocell::internal
