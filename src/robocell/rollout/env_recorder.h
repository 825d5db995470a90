// EnvRecorder: records what an environment does as episodes of a dataset, like those that
// generation makes: durable, verified, replayable (replay.h, env_replay.h).
//
//   Env env(config);
//   EnvRecorder recorder(env, "out/teleop");
//   env.Reset({.seed = 1});
//   ... env.Step(action) ...          // one row each
//   env.Reset();                      // saves the first episode; the next one begins
//   ... env.Step(action) ...
//   recorder.Close();                 // saves the last one
//
// An episode begins with the first step after a reset or after going back to a state, and is saved
// by the next one, by Save() or by Close(). Until then readers see nothing of it, and Discard() and
// the destructor remove it. What a killed process leaves half-written is hidden, and the next
// recorder of the same prefix removes it. A step that an error ended halfway is no row.
//
// Columns: the features of the cell, as in generated episodes; what the environment showed
// (`observation/...`) and was asked (`action/...`), by their paths in its dictionaries; and what
// came of it. With `images` the frames of its streams, as they were shown. Rows have as many control
// ticks as the steps took: `control_tick` is the first one of each.
//
// Errors: ArgumentError for a folder that is no dataset, is a run's, or has episodes of another
// configuration or of other code of the task and features, and for streams without colour images;
// IoError when the disk fails, out of Step or Reset too: then the episode is gone, and recording
// goes on with the next reset. Threads: those of the environment, which must outlive it.
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
  std::string prefix = "episode";  // ids are "episode-000000", counting on from what is there
  bool images = true;
  std::string metadata_json = "{}";  // an object of your own, kept as `user` in the metadata
};

// What is known of an episode when it is saved from outside.
struct EnvEpisodeEnd {
  std::optional<bool> success = {};  // unset: what the task said of the last step
  std::string reason = {};           // "": "success", "diverged" or "stopped"
};

// The features of an environment's cell that its episodes record.
CellFeatures RecordedFeatures(const Env& env);

class EnvRecorder {
 public:
  EnvRecorder(Env& env, const std::filesystem::path& dataset, EnvRecorderOptions options = {});
  ~EnvRecorder();  // discards what was not saved, with a warning
  EnvRecorder(const EnvRecorder&) = delete;
  EnvRecorder& operator=(const EnvRecorder&) = delete;

  // Saves the present episode and returns its id, unset when it has no row. What follows is
  // recorded from the next reset on.
  std::optional<std::string> Save(const EnvEpisodeEnd& end = {});
  // Drops it instead.
  void Discard();
  // Saves it, and records no more. May be repeated.
  void Close();
  bool closed() const;

  const std::filesystem::path& dataset() const;
  // Ids of what was saved.
  const std::vector<std::string>& episodes() const;
  // Steps of the present episode.
  int rows() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
