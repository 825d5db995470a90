// For tests only: rollouts from a start of the demo, an expert that sends commands, and a task that is
// always done.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/rollout/rollout.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {

// Sends the arm to a new position every second action, and holds it still between.
class Commanding : public Expert {
 public:
  Commanding(Pose leaf_in_robot, int actions) : leaf_(leaf_in_robot), left_(actions) {}
  void Begin(const Scene&, Rng&) override {}
  Action Act(const Scene&, Rng&) override {
    if (left_-- % 2) return {{"rc7", {{"arm", GroupCommand::LeafPose(leaf_)}}}};
    return {};
  }
  bool done() const override { return left_ <= 0; }
  std::string failure() const override { return ""; }
  int phase() const override { return 0; }
  std::vector<std::string> phase_names() const override { return {"all"}; }

 private:
  Pose leaf_;
  int left_;
};

// Rollouts from a start of the demo, without cameras.
class RolloutTest : public ::testing::Test {
 protected:
  RolloutTest() {
    run = Demo();
    run.cameras.streams = {};
    Rng rng = Rng::Stream(1, "start");
    for (int attempt = 0; !start; ++attempt)
      start = std::move(MakeSampler(run)->Sample({0, 0, attempt}, rng).start);
  }
  RolloutResult Rollout(Expert& expert) {
    Rng rng = Rng::Stream(2, "expert");
    return RunRollout(run, *start, expert, rng,
                      {.dataset = folder.path(),
                       .episode_id = "e",
                       .metadata_json = "{}",
                       .keep_failures = true});
  }

  TempDir folder;
  RunConfig run;
  std::optional<EpisodeStart> start;
};

// A task that accepts every state.
class Content : public Task {
 public:
  void Begin(const Scene&) override {}
  TaskVerdict Judge(const Scene&) override { return {.reward = 1, .success = true}; }
  std::string instruction() const override { return "do as you like"; }
  std::vector<std::string> objects() const override { return {}; }
};

}  // namespace robocell::internal
