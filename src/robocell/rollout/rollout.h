// Rollout: one recorded attempt: expert and stepper act from a start state until success, failure
// or the last step.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/base/stop.h"
#include "robocell/data/episode_writer.h"
#include "robocell/expert/expert.h"
#include "robocell/render/renderer.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

// Seconds by stage; no second counts twice.
struct RolloutTimes {
  double acting = 0;     // expert, simulation and task
  double rendering = 0;  // waiting for images and encoders, which work beside the rest
  double writing = 0;    // rows and control ticks, and committing
};

// Pose commands of a group that had no IK solution; the group kept its target.
struct NoIkSolution {
  int actions = 0;
  // The first of them: "0.33 s, in phase 'lift', 0.120 m and 0.30 rad from the pose".
  std::string first = {};
};

struct RolloutResult {
  bool success = false;
  bool stopped = false;  // true if the stop request ended it; nothing was stored
  bool committed = false;
  std::string failure;     // why it did not succeed; "" on success
  std::string divergence;  // if it diverged: at what time, and which joint showed it
  std::map<std::string, NoIkSolution> ik_failures;  // by "robot/group"
  int rows = 0;
  RolloutTimes times;
};

struct RolloutOptions {
  std::filesystem::path dataset;
  std::string episode_id;
  std::string metadata_json;  // known before the rollout: seeds, attempt, identity
  bool keep_failures = false;
  Renderer* renderer = nullptr;  // required if the run has streams
  // Further renderers of the same images: each has a thread of its own, which draws some rows.
  std::vector<Renderer*> more_renderers = {};
  RenderWhen render = RenderWhen::kAlways;
  StopRequest stop = {};
  std::function<void()> before_commit = {};  // an exception leaves nothing on the disk
  // A HookError of the expert ends the rollout as a failure, whose reason is PolicyError's
  // (expert_calls.h): for evaluations. Otherwise it is rethrown, and nothing is kept.
  bool expert_errors_fail = false;
  // A success counts only if its controls alone lead to success again (exact_replay.h).
  bool judge_replay = false;
  // False: nothing is written, whatever the result. Images are drawn only for an expert that looks.
  bool stores = true;
  // The randomness of the run's noise; required if it has `noise`.
  std::optional<Rng> noise = {};
  // Whether the noise displaced the start, for the record; unset if the run displaces none.
  std::optional<bool> start_displaced = {};
};

// Commits the episode if it succeeded, or failed and failures are kept; else, and without `stores`,
// nothing stays on the disk.
RolloutResult RunRollout(const RunConfig& run, EpisodeStart& start, Expert& expert, Rng& rng,
                         const RolloutOptions& options);

}  // namespace robocell::internal
