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
#include "robocell/task/testing/driving_runs.h"

namespace robocell::internal {
namespace {

TEST(DriveThen, DrivesToTheObjectAndPicksIt) {
  const RunConfig run = PicksFromTheTable();
  DrivingStartSampler sampler(run);
  const EpisodeStart start = StartOf(sampler, 2);
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

}  // namespace
}  // namespace robocell::internal
