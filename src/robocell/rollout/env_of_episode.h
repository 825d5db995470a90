// Rebuilds the environment of a recorded episode (env_recorder.h) from the files that the dataset
// keeps, and repeats the recorded actions in an environment.
//
//   const Episode episode("out/teleop/episode-000003");
//   const std::unique_ptr<Env> env = EnvOfEpisode(episode);
//   const ReplayResult result = ReplayActions(*env, episode);
//   if (!result.ok()) LogWarn(result.Text());
//
// VerifyReplay (replay.h) checks less: that the recorded controls give the recorded states, without
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

// Names in episodes of environments: the numbers of the EnvState before the first action, and the
// first control tick of each row.
inline constexpr std::string_view kEnvStateColumn = "env_state";
inline constexpr std::string_view kControlTickColumn = "control_tick";
// Key of the results that contains the observation after the last action, by the names of
// observation features.
inline constexpr const char* kFinalObservation = "final_observation";

// Returns true if an environment recorded the episode.
bool IsOfEnv(const Episode& episode);

// Returns a configuration as YAML whose model names are valid on every machine or are paths in the
// dataset.
std::string PortableConfig(const EnvConfig& config);

// Returns the files of a user's code that a configuration uses, with their hashes, as JSON: the
// form in which episodes keep them in their environment.
nlohmann::json CodeRecord(const EnvConfig& config);
// Returns the differences of a configuration and its code from those of an episode, one line each.
// Fields that no row depends on are ignored: a window and real time.
std::vector<std::string> DifferencesFromEpisode(const EnvConfig& config, const Episode& episode);

// Returns the environment that recorded an episode, in the scene that the dataset keeps, without a
// window and not in real time; without `images` it has no streams. Throws ArgumentError for an
// episode of a run or of a saved scene, NotFoundError for a task that is not registered, SpecError
// if the code of its task or features is not the recorded one, and the errors of RecordedScene.
std::unique_ptr<Env> EnvOfEpisode(const Episode& episode, bool images = false,
                                  const DataFactory& factory = {});

struct EnvReplayOptions {
  StateFrame frame = StateFrame::kWorld;
  // Largest difference of each number of the observations and of the rewards. 0: equal to the bit.
  double tolerance = 0;
  std::function<void()> poll = {};  // called as in Env::Step
};

// Restores the start of an episode and repeats its actions until a number differs from the recorded
// one by more than the tolerance; row rows() is the observation after the last action. A rig that
// stands elsewhere needs StateFrame::kRoot. Before anything changes, throws ArgumentError for an
// episode of another configuration, SpecError for one of other code and IoError for one without a
// row.
ReplayResult ReplayActions(Env& env, const Episode& episode, const EnvReplayOptions& options = {});

}  // namespace robocell
