#include "robocell/expert/augment_expert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/expert/skill_expert.h"
#include "robocell/robot/robot.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

constexpr int kTicks = 33;

RunConfig StackRun() {
  RunConfig run = ExampleRun("tasks/stack.yaml");
  run.task.If<StackTaskConfig>()->cubes = 2;
  run.cameras.streams = {};
  run.augment.emplace().dataset = "unused";
  return run;
}

EpisodeStart StartOf(const RunConfig& run, int seed) {
  StartSampler sampler(run);
  for (int attempt = 0;; ++attempt) {
    Rng rng = Rng::Stream(1, "start", seed, attempt);
    SampleResult sample = sampler.Sample({.episode = seed, .attempt = attempt}, rng);
    if (!sample.start) continue;
    sample.start->task->Begin(sample.start->scene);
    return *std::move(sample.start);
  }
}

// Lets an expert act and returns what it showed, as a dataset would say it; `success` of the end.
Demonstration RollOut(EpisodeStart& start, Expert& expert, bool& success) {
  Demonstration demo{.episode = "shown", .object_kind = start.object_kinds.front()};
  Robot robot = RobotsOf(start.scene).front();
  Rng rng = Rng::Stream(1, "expert");
  expert.Begin(start.scene, rng);
  demo.phases = expert.phase_names();
  success = false;
  while (!expert.done() && demo.rows() < 800) {
    start.scene.SyncPoses();
    demo.phase.push_back(expert.phase());
    demo.tcp_in_world.push_back(robot.tcp_in_world());
    for (const std::string& object : start.task->objects())
      demo.bodies[object].push_back(start.scene.body_pose(object));
    EXPECT_TRUE(robot.Apply(expert.Act(start.scene, rng).at(robot.name())).ok);
    demo.base_in_world.push_back(robot.base_in_world());
    demo.target_in_world.push_back(robot.base_in_world() *
                                   robot.FkFrame(robot.controller("arm").commanded_joint_pos()));
    demo.opening.push_back(robot.controller("gripper").target()[0]);
    for (int i = 0; i < kTicks; ++i) {
      robot.Update();
      EXPECT_TRUE(start.scene.Step().ok());
    }
    success = start.task->Judge(start.scene).success;
  }
  return demo;
}

class AugmentExpertTest : public ::testing::Test {
 protected:
  // A stack of two cubes that the scripted expert has shown, once for all tests.
  static const Demonstration& Shown() {
    static const Demonstration shown = [] {
      const RunConfig run = StackRun();
      EpisodeStart start = StartOf(run, 0);
      SkillExpert expert(run, start);
      bool success = false;
      Demonstration demo = RollOut(start, expert, success);
      EXPECT_TRUE(success);
      demo.segments = FindSegments(demo);
      return demo;
    }();
    return shown;
  }
  static Demonstrations Sources(std::vector<Demonstration> demos = {Shown()}) {
    return std::make_shared<const std::vector<Demonstration>>(std::move(demos));
  }
  const RunConfig run = StackRun();
};

TEST_F(AugmentExpertTest, StacksFromAnotherStart) {
  ASSERT_EQ(Shown().segments.size(), 2U);
  EpisodeStart start = StartOf(run, 1);
  AugmentExpert expert(run, start, Sources());
  bool success = false;
  const Demonstration made = RollOut(start, expert, success);
  EXPECT_EQ(expert.failure(), "");
  EXPECT_TRUE(success);
  EXPECT_EQ(made.phases.front(), "move");
  EXPECT_THAT(expert.results_json(), ::testing::HasSubstr(R"("source":"shown")"));
  // The cube is put down where the source put it, seen from the cube below.
  const auto last = [](const Demonstration& demo) {
    const std::string below = Shown().segments[1].reference, above = Shown().segments[1].held;
    return demo.bodies.at(below).back().inverse() * demo.bodies.at(above).back();
  };
  EXPECT_LT((last(made).translation() - last(Shown()).translation()).norm(), 0.006);
}

TEST_F(AugmentExpertTest, GivesUpWithAReasonWithoutAFittingSource) {
  Demonstration other = Shown();
  for (DemoSegment& segment : other.segments) {
    if (!segment.held.empty()) continue;
    other.bodies["teapot"] = other.bodies.at(segment.reference);
    segment.reference = "teapot";
  }
  EpisodeStart start = StartOf(run, 1);
  AugmentExpert unknown(run, start, Sources({other}));
  Rng rng = Rng::Stream(1, "expert");
  unknown.Begin(start.scene, rng);
  EXPECT_TRUE(unknown.done());
  EXPECT_EQ(unknown.failure(), "no source episode has what this start has");
  EXPECT_NO_THROW(unknown.Act(start.scene, rng));
  // One that leads the hand too far away.
  Demonstration far = Shown();
  for (Pose& target : far.target_in_world) target = Pose(Eigen::Vector3d(9, 0, 0)) * target;
  AugmentExpert beyond(run, start, Sources({far}));
  beyond.Begin(start.scene, rng);
  EXPECT_EQ(beyond.failure(), "the arm can follow no source episode here");
}

TEST_F(AugmentExpertTest, TakesTheNextSourceIfTheArmCannotFollowTheNearest) {
  Demonstration bent = Shown();
  bent.episode = "bent";  // ends out of reach
  bent.target_in_world[static_cast<size_t>(bent.segments[0].end) - 1] =
      Pose(Eigen::Vector3d(0, 0, 5));
  EpisodeStart start = StartOf(run, 1);
  AugmentExpert expert(run, start, Sources({bent, Shown()}));
  Rng rng = Rng::Stream(1, "expert");
  expert.Begin(start.scene, rng);
  EXPECT_FALSE(expert.done());
  EXPECT_THAT(expert.results_json(), ::testing::HasSubstr(R"("source":"shown")"));
}

}  // namespace
}  // namespace robocell::internal
