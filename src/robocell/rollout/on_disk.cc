#include "robocell/rollout/on_disk.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/data/episode_state.h"
#include "robocell/rollout/run_origin.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// The folders of a run's attempts.
class Attempts {
 public:
  explicit Attempts(const RunConfig& run) : run_(run) {}

  struct Found {
    internal::EpisodeLook look;
    std::optional<Episode> episode = {};  // if it is complete
    EarlierAttempts earlier = {};         // its own
  };
  Found Look(const PlanItem& item, int attempt);

 private:
  std::string WhyNotOurs(const Episode& episode);
  const RunConfig& run_;
  std::optional<internal::RunOrigin>
      origin_;  // made for the first episode: it needs the run's models
};

// Repair may set episodes of other models aside: verify recognises them by dataset.json.
internal::EpisodeLook Blocked(const fs::path& folder, const std::string& what,
                              std::string_view advice = internal::kLeftAlone) {
  return {.state = internal::EpisodeState::kBroken,
          .problem = fmt::format("'{}' is {}: {}", folder.string(), what, advice)};
}

// Returns "" for an episode of this run, else why it is not.
std::string Attempts::WhyNotOurs(const Episode& episode) {
  constexpr size_t kMost = 3;
  if (!origin_) origin_.emplace(run_);
  const auto changes = origin_->ChangesSince(episode);
  if (!changes) return "an episode that no run made, in the place of one of this run";
  std::vector<std::string> lines = LinesOf(*changes);
  if (lines.empty())
    return !episode.success() && run_.keep == Keep::kSuccesses
               ? "a failed episode in a dataset of successes"
               : "";
  const size_t more = lines.size() - std::min(lines.size(), kMost);
  lines.resize(lines.size() - more);
  return fmt::format("an episode of another run ({}{})", fmt::join(lines, "; "),
                     more ? fmt::format("; and {} more", more) : "");
}

Attempts::Found Attempts::Look(const PlanItem& item, int attempt) {
  const fs::path folder = fs::path(run_.output) / EpisodeId(run_, item, attempt);
  Found found{.look = internal::LookAtEpisode(folder)};
  if (found.look.state != internal::EpisodeState::kWhole) return found;
  try {
    found.episode.emplace(folder);
    if (const std::string why = WhyNotOurs(*found.episode); !why.empty())
      return {.look = Blocked(folder, why, internal::kMoveAway)};
    found.earlier = EarlierAttemptsIn(found.episode->metadata_json());
    return found;
  } catch (const Json::exception& error) {
    return {.look = Blocked(folder,
                            fmt::format("an episode with strange metadata ({})", error.what()))};
  } catch (const IoError& error) {
    return {.look = Blocked(folder, fmt::format("damaged ({})", error.what()))};
  }
}

[[noreturn]] void ThrowBroken(const RunConfig& run, const std::string& problem) {
  if (problem.ends_with(internal::kMoveAway)) throw IoError(problem);
  throw IoError(fmt::format("{}\nSet it aside: robocell verify --repair {}", problem,
                            internal::ShellWord(run.output)));
}

ItemOnDisk LookFor(const RunConfig& run, Attempts& attempts, const PlanItem& item) {
  ItemOnDisk found;
  std::set<int> missing;
  const int count = run.keep == Keep::kAll ? run.max_attempts : 1;
  for (int attempt = 0; attempt < count && !found.success; ++attempt) {
    const Attempts::Found here = attempts.Look(item, attempt);
    if (here.look.state == internal::EpisodeState::kBroken)
      found.broken.push_back(here.look.problem);
    if (here.look.state == internal::EpisodeState::kAbsent) missing.insert(attempt);
    for (size_t i = 0; i < here.earlier.size(); ++i)
      if (here.earlier[i].left_nothing()) missing.erase(static_cast<int>(i));
    found.success = here.look.success;
    const bool last = found.success || attempt == run.max_attempts - 1;
    if (last && here.episode) found.complete = missing.empty() && found.broken.empty();
    if (run.keep == Keep::kFirst) found.complete = here.episode && found.broken.empty();
  }
  return found;
}

}  // namespace

std::string EpisodeId(const RunConfig& run, const PlanItem& item, int attempt) {
  return run.keep == Keep::kAll ? fmt::format("{}_a{:02}", item.id, attempt) : item.id;
}

ItemOnDisk LookForItem(const RunConfig& run, const PlanItem& item) {
  Attempts attempts(run);
  return LookFor(run, attempts, item);
}

PlanOnDisk LookForItems(const RunConfig& run, const std::vector<PlanItem>& items) {
  PlanOnDisk all;
  Attempts attempts(run);
  for (const PlanItem& item : items) {
    const ItemOnDisk found = LookFor(run, attempts, item);
    if (found.complete && (found.success || run.keep == Keep::kFirst))
      all.made.push_back(item.id);
    else
      all.broken.insert(all.broken.end(), found.broken.begin(), found.broken.end());
  }
  return all;
}

std::optional<Episode> KeptAttempt(const RunConfig& run, const PlanItem& item, int attempt) {
  Attempts::Found found = Attempts(run).Look(item, attempt);
  if (found.look.state == internal::EpisodeState::kBroken) ThrowBroken(run, found.look.problem);
  return std::move(found.episode);
}

bool IsComplete(const RunConfig& run, const PlanItem& item) {
  const ItemOnDisk found = LookForItem(run, item);
  if (!found.broken.empty()) ThrowBroken(run, found.broken.front());
  return found.complete;
}

using Json = nlohmann::json;

std::string ToJson(const EarlierAttempts& earlier) {
  Json list = Json::array();
  for (const EarlierAttempt& attempt : earlier) {
    Json& entry = list.emplace_back(Json{{"object_kind", attempt.object_kind},
                                         {attempt.refused ? "refused" : "failed", attempt.reason}});
    if (attempt.raised) entry["raised"] = true;
  }
  return list.dump();
}

EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json) try {
  EarlierAttempts earlier;
  const Json metadata = Json::parse(metadata_json);
  if (!metadata.contains(kEarlierAttempts)) return earlier;
  for (const Json& attempt : metadata.at(kEarlierAttempts)) {
    const bool refused = attempt.contains("refused");
    earlier.push_back({.object_kind = attempt.at("object_kind"),
                       .refused = refused,
                       .raised = attempt.value("raised", false),
                       .reason = attempt.at(refused ? "refused" : "failed")});
  }
  return earlier;
} catch (const Json::exception& error) {
  throw IoError(std::string("its ") + kEarlierAttempts + " cannot be read: " + error.what());
}

}  // namespace robocell
