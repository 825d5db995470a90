// From an episode of an environment (env_recorder.h) back to the environment: the same one is made
// from what the dataset keeps, and an environment does what was recorded again.
//
//   const Episode episode("out/teleop/episode-000003");
//   const std::unique_ptr<Env> env = EnvOfEpisode(episode);
//   const ReplayResult report = ReplayActions(*env, episode);
//   if (!report.ok()) LogWarn(report.Text());
//
// VerifyReplay (replay.h) asks less: whether the recorded controls give the recorded states, without
// the environment and its task.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include <nlohmann/json_fwd.hpp>

#include "robocell/data/episode_reader.h"
#include "robocell/env/env.h"
#include "robocell/rollout/replay.h"

namespace robocell {

// Of episodes of environments: the numbers of the EnvState before the first action, and the first
// control tick of each row.
inline constexpr std::string_view kEnvStateColumn = "env_state";
inline constexpr std::string_view kControlTickColumn = "control_tick";
// In the results: what the last action led to, by the names of observation features.
inline constexpr const char* kFinalObservation = "final_observation";

// Whether an environment recorded it.
bool IsOfEnv(const Episode& episode);

// A configuration as YAML whose models are named as every machine knows them, or by where the
// dataset keeps them.
std::string PortableConfig(const EnvConfig& config);

// The files of a user's code that a configuration uses, with their hashes, as episodes keep them in
// their environment: JSON.
nlohmann::json CodeRecord(const EnvConfig& config);
// Returns the differences of a configuration and its code from those of an episode, one line each,
// but for what no row depends on: a window and real time.
std::vector<std::string> DifferencesFromEpisode(const EnvConfig& config, const Episode& episode);

// The environment that recorded an episode, in the scene that the dataset keeps, never in real time
// or with a window; without `images` it has no streams. ArgumentError for other episodes and for
// those of a saved scene, NotFoundError for a task that is not registered, SpecError when the
// code of its task or features is not the recorded one, errors of RecordedScene.
std::unique_ptr<Env> EnvOfEpisode(const Episode& episode, bool images = false,
                                  const DataFactory& factory = {});

struct EnvReplayOptions {
  StateFrame frame = StateFrame::kWorld;
  // Of each number of the observations, and of the rewards. 0: the same to the bit or not.
  double tolerance = 0;
  std::function<void()> poll = {};  // as of Env::Step
};

// Goes back to the start of an episode and gives its actions again, until a number is farther from
// what was recorded than the tolerance; row rows() is what the last action led to. With
// StateFrame::kRoot, for a rig that stands elsewhere, it needs one. ArgumentError for an episode of
// another configuration, SpecError for one of other code and IoError for one without a row, before
// anything changes.
ReplayResult ReplayActions(Env& env, const Episode& episode, const EnvReplayOptions& options = {});

}  // namespace robocell
