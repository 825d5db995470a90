#include "robocell/datagen/on_disk.h"

#include <fmt/format.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/data/episode_state.h"

namespace robocell {
namespace {

EpisodeLook LookAtAttempt(const RunConfig& run, const PlanItem& item, int attempt) {
  const std::filesystem::path folder =
      std::filesystem::path(run.output) / EpisodeId(run, item, attempt);
  EpisodeLook look = LookAtEpisode(folder);
  if (look.state == EpisodeState::kWhole && !look.success && run.keep == Keep::kSuccesses) {
    return {.state = EpisodeState::kBroken,
            .problem = fmt::format("'{}' is a failed episode in a dataset of successes: repair "
                                   "leaves it alone, move it away yourself",
                                   folder.string())};
  }
  return look;
}

[[noreturn]] void ThrowBroken(const RunConfig& run, const std::string& problem) {
  throw IoError(fmt::format("{}\nSet it aside: robocell verify --repair {}", problem, run.output));
}

}  // namespace

std::string EpisodeId(const RunConfig& run, const PlanItem& item, int attempt) {
  return run.keep == Keep::kAll ? fmt::format("{}_a{:02}", item.id, attempt) : item.id;
}

ItemOnDisk LookForItem(const RunConfig& run, const PlanItem& item) {
  ItemOnDisk found;
  const int attempts = run.keep == Keep::kAll ? run.max_attempts : 1;
  for (int attempt = 0; attempt < attempts && !found.success; ++attempt) {
    const EpisodeLook look = LookAtAttempt(run, item, attempt);
    found.success = look.success;
    found.complete = look.state == EpisodeState::kWhole && attempt == run.max_attempts - 1;
    if (look.state == EpisodeState::kBroken) found.broken.push_back(look.problem);
  }
  found.complete |= found.success;
  return found;
}

PlanOnDisk LookForItems(const RunConfig& run, const std::vector<PlanItem>& items) {
  PlanOnDisk all;
  for (const PlanItem& item : items) {
    const ItemOnDisk found = LookForItem(run, item);
    if (found.success)
      all.made.push_back(item.id);
    else
      all.broken.insert(all.broken.end(), found.broken.begin(), found.broken.end());
  }
  return all;
}

bool IsAttemptKept(const RunConfig& run, const PlanItem& item, int attempt) {
  const EpisodeLook look = LookAtAttempt(run, item, attempt);
  if (look.state == EpisodeState::kBroken) ThrowBroken(run, look.problem);
  return look.state == EpisodeState::kWhole;
}

bool IsComplete(const RunConfig& run, const PlanItem& item) {
  const ItemOnDisk found = LookForItem(run, item);
  if (!found.broken.empty() && !found.success) ThrowBroken(run, found.broken.front());
  return found.complete;
}

}  // namespace robocell
