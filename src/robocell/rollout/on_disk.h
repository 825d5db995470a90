// Looks up the items of a plan on the disk: the one place that decides which exist and which are
// still missing. Success is counted from the disk.
//
//   const ItemOnDisk found = LookForItem(run, item);
//   if (!found.broken.empty()) ...        // name it: neither count it nor write over it
//   else if (!found.complete) runner.Run(item);
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/data/episode_reader.h"
#include "robocell/rollout/plan.h"

namespace robocell {

// Returns the episode id of an attempt. If failures are kept, the attempts of an item have separate
// ids: "s0003_e0001_a02".
std::string EpisodeId(const RunConfig& run, const PlanItem& item, int attempt);

// Only episodes of the run itself count: made with the same fields, models and versions. One that
// was copied there from another dataset stands in the way.
struct ItemOnDisk {
  bool success = false;  // a successful episode is there
  // Nothing is left to do: the success, or else the last attempt is there, and of the attempts
  // before it each one that the run keeps.
  bool complete = false;
  std::vector<std::string> broken = {};  // what stands in the way, one text each
};
ItemOnDisk LookForItem(const RunConfig& run, const PlanItem& item);

// The same of many items, by their ids.
struct PlanOnDisk {
  std::vector<std::string> made;    // complete items with a success
  std::vector<std::string> broken;  // texts: what stands in the way of the others
};
PlanOnDisk LookForItems(const RunConfig& run, const std::vector<PlanItem>& items);

// The episode of an attempt, when it is there and whole. IoError, with the command that sets it
// aside, when something stands in its way.
std::optional<Episode> KeptAttempt(const RunConfig& run, const PlanItem& item, int attempt);
// LookForItem(...).complete, with the same error.
bool IsComplete(const RunConfig& run, const PlanItem& item);

// The results of earlier attempts at an episode's item: a part of its metadata. A refused attempt
// leaves nothing else, and with `keep: successes` neither does a failed one.
//
//   "earlier_attempts": [{"object_kind": "mug", "refused": "too far"},
//                        {"object_kind": "cup", "failed": "dropped"}]
struct EarlierAttempt {
  std::string object_kind;  // "": it is not known
  bool refused = false;     // the start; else the rollout failed
  std::string reason;
};
using EarlierAttempts = std::vector<EarlierAttempt>;  // by their numbers

inline constexpr const char* kEarlierAttempts = "earlier_attempts";

// A JSON list.
std::string ToJson(const EarlierAttempts& earlier);
// Reads them from an episode's metadata; none if there are none. IoError for invalid metadata.
EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json);

}  // namespace robocell
