// EnvRecorder: records an environment as episodes of a dataset, like those that generation makes:
// durable, verified, replayable (replay.h, env_of_episode.h).
//
//   Env env(config);
//   EnvRecorder recorder(env, "out/teleop");
//   env.Reset({.seed = 1});
//   ... env.Step(action) ...          // one row each
//   env.Reset();                      // saves the first episode; the next one begins
//   ... env.Step(action) ...
//   recorder.Close();                 // saves the last one
//
// An episode begins with the first step after a reset or after restoring a state, and is saved by
// the next of these, by Save() or by Close(). Until then it is invisible to readers, and Discard()
// and the destructor remove it. The half-written episode of a killed process is hidden, and the
// next recorder with the same prefix removes it. A step that an error ended halfway is not a row.
//
// Columns: the features of the cell, as in generated episodes; the observation (`observation/...`)
// and the action (`action/...`), by their paths in the environment's dictionaries; and the outcome.
// Actions by the names of features (Env::Act) have the cell's columns alone.
// With `images`, also the frames of its streams as they were shown. A row has as many control ticks
// as its step took: `control_tick` is the first one of each row.
//
// Throws ArgumentError for a folder that is not a dataset, belongs to a run, or has episodes of
// another configuration or of other code of the task and features, and for streams without colour
// images. Throws IoError when the disk fails, also from Step or Reset: then the episode is lost,
// and recording continues with the next reset. Threads: those of the environment, which must
// outlive it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/env/env.h"
#include "robocell/features/cell_features.h"

namespace robocell {

struct EnvRecorderOptions {
  std::string prefix = "episode";  // ids are "episode-000000", counting on from existing ones
  bool images = true;
  std::string metadata_json = "{}";  // your own JSON object, kept as `user` in the metadata
};

// End of an episode that the caller saves.
struct EnvEpisodeEnd {
  std::optional<bool> success = {};  // unset: the task's verdict on the last step
  std::string reason = {};           // "": "success", "diverged" or "stopped"
};

// Returns the features of an environment's cell that its episodes record. They read the task of
// the environment, which must outlive them.
CellFeatures RecordedFeatures(const Env& env);

class EnvRecorder {
 public:
  EnvRecorder(Env& env, const std::filesystem::path& dataset, EnvRecorderOptions options = {});
  ~EnvRecorder();  // discards an unsaved episode with a warning
  EnvRecorder(const EnvRecorder&) = delete;
  EnvRecorder& operator=(const EnvRecorder&) = delete;

  // Saves the present episode and returns its id; unset if it has no row. Recording continues with
  // the next reset.
  std::optional<std::string> Save(const EnvEpisodeEnd& end = {});
  // Drops the present episode.
  void Discard();
  // Saves the present episode and stops recording. May be repeated.
  void Close();
  bool closed() const;

  const std::filesystem::path& dataset() const;
  // Returns the ids of the saved episodes.
  const std::vector<std::string>& episodes() const;
  // Returns the number of steps of the present episode.
  int rows() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
