#include "robocell/rollout/lost_manifest.h"

#include <set>

#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/rollout/run_origin.h"

namespace robocell {
namespace {

// Unset for a folder that is not a dataset.
std::optional<Dataset> DatasetIn(const std::string& folder) {
  try {
    return Dataset(folder);
  } catch (const ArgumentError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::vector<std::string>> ChangesSinceEpisodes(const RunConfig& run) {
  const std::optional<Dataset> dataset = DatasetIn(run.output);
  if (!dataset) return std::nullopt;
  RunOrigin origin(run);
  bool found = false;
  std::set<std::string> changes;
  for (const Episode& episode : *dataset) {
    const auto lines = origin.ChangesSince(episode);
    if (!lines) continue;
    found = true;
    changes.insert(lines->begin(), lines->end());
  }
  if (!found) return std::nullopt;
  return std::vector<std::string>(changes.begin(), changes.end());
}

}  // namespace robocell
