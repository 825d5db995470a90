// Checks whether an episode was made from the present inputs of its run. This is the one place that
// compares fields, versions and models. A model may be edited during the run: the models
// that the dataset was begun with still belong to it.
//
//   RunOrigin origin(run);
//   const auto changes = origin.ChangesSince(episode);
//   if (changes && changes->empty()) ...  // one of the run's own
//
// Models are looked up and hashed when an episode names them, each once: a run may have hundreds.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robocell/data/episode_reader.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

class RunOrigin {
 public:
  explicit RunOrigin(const RunConfig& run);  // must outlive this object

  // Returns the differences, as in Differences(); unset for an episode that no run made. A model is
  // identified by its file's name and content. Models that the run does not list are ignored, and
  // so are those of the user's own tasks, whose sampler may bring others of the same name.
  std::optional<std::vector<InputDifference>> ChangesSince(const Episode& episode);

 private:
  using PathsByName = std::map<std::string, std::set<std::string>>;  // names of the files
  std::set<std::string>& StoredPathsOf(const std::string& name);
  const RunConfig& run_;
  RunInputs now_;                           // no files
  std::optional<PathsByName> models_ = {};  // models on this machine
  PathsByName stored_ = {};                 // models as stored by datasets
};

// The key in an episode's metadata for the parts of its Runner that no name of the run stands for:
// "sampler", "expert".
inline constexpr const char* kUnregisteredParts = "unregistered";
// Returns these parts of an episode; empty if all were registered.
std::vector<std::string> UnregisteredParts(const Episode& episode);

// Returns how the inputs of the episodes differ from those of the run, each difference once, for a
// dataset that lost its dataset.json; empty if the manifest can be written again. Unset
// without generated episodes.
std::optional<std::vector<InputDifference>> ChangesSinceEpisodes(const RunConfig& run);

}  // namespace robocell::internal
