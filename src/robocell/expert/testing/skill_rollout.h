// For tests only: one start of a task whose goal is relations, and its expert.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/task_spec.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {

struct SkillOutcome {
  bool success = false;
  std::string failure;
  std::vector<std::string> phases;  // in order, without repetitions
};

// With the robot of an example. `disturb` is called with the row and the phase before each row is simulated.
using Disturbance = std::function<void(Scene&, int, const std::string&)>;
inline SkillOutcome RollOutSkills(const TaskSpec& task, uint64_t seed = 1,
                                  const Disturbance& disturb = {},
                                  const std::string& example = "pick_and_place.yaml") {
  RunConfig run = ExampleRun(example);
  run.start = {};
  run.task = task;
  StartSampler sampler(run);
  for (int attempt = 0; attempt < 40; ++attempt) {
    Rng rng = Rng::Stream(seed, "start", attempt);
    SampleResult sample = sampler.Sample({.attempt = attempt}, rng);
    if (!sample.start) continue;
    Scene scene = sample.start->scene;
    Robot robot = RobotsOf(scene).front();
    Task& judge = *sample.start->task;
    judge.Begin(scene);
    SkillOutcome outcome;
    EXPECT_FALSE(judge.Judge(scene).success);
    const std::shared_ptr<Expert> expert = FindExpertKind(task.kind())->Make(run, *sample.start);
    expert->Begin(scene, rng);
    for (int row = 0; row < 700 && !expert->done(); ++row) {
      const Action action = expert->Act(scene, rng);
      const std::string phase = expert->phase_names()[static_cast<size_t>(expert->phase())];
      if (outcome.phases.empty() || outcome.phases.back() != phase) outcome.phases.push_back(phase);
      if (disturb) disturb(scene, row, phase);
      if (action.contains(robot.name())) {
        EXPECT_TRUE(robot.Apply(action.at(robot.name())).ok);
      }
      for (int i = 0; i < 33; ++i) {
        robot.Update();
        EXPECT_TRUE(scene.Step().ok());
      }
      const TaskVerdict verdict = judge.Judge(scene);
      EXPECT_GE(verdict.progress, 0);
      EXPECT_LE(verdict.progress, 1);
      outcome.success = verdict.success;
    }
    outcome.failure = expert->failure();
    return outcome;
  }
  throw Error("no start in 40 attempts");
}

}  // namespace robocell
