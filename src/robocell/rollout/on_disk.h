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

// Only episodes of the run itself count: made with the same fields, models and versions. An episode
// copied from another dataset blocks its item.
struct ItemOnDisk {
  bool success = false;  // there is a successful episode
  // True if nothing is left to do: the success or else the last attempt is there, and so is each
  // earlier attempt that the run keeps.
  bool complete = false;
  std::vector<std::string> broken = {};  // texts about what blocks the item, one each
};
ItemOnDisk LookForItem(const RunConfig& run, const PlanItem& item);

// The state of many items on the disk, by their ids.
struct PlanOnDisk {
  std::vector<std::string> made;    // complete items with a success
  std::vector<std::string> broken;  // texts about what blocks the others
};
PlanOnDisk LookForItems(const RunConfig& run, const std::vector<PlanItem>& items);

// Returns the episode of an attempt if it is there and complete. Throws IoError, with the command
// that sets it aside, if something blocks it.
std::optional<Episode> KeptAttempt(const RunConfig& run, const PlanItem& item, int attempt);
// Returns LookForItem(...).complete, with the same error.
bool IsComplete(const RunConfig& run, const PlanItem& item);

// The results of earlier attempts at an episode's item: a part of its metadata. A refused attempt
// and one in which a user's code raised leave no other record, and with `keep: successes` neither
// does a failed one.
//
//   "earlier_attempts": [{"object_kind": "mug", "refused": "too far"},
//                        {"object_kind": "cup", "failed": "dropped"},
//                        {"object_kind": "", "failed": "mine.py:3, in act: ...", "raised": true}]
struct EarlierAttempt {
  std::string object_kind;  // "": unknown
  bool refused = false;     // the start; else the rollout failed
  bool raised = false;      // it failed by an exception
  std::string reason;
  // Returns true if it left no episode, even if failures are kept.
  bool left_nothing() const { return refused || raised; }
};
using EarlierAttempts = std::vector<EarlierAttempt>;  // earlier attempts by number

inline constexpr const char* kEarlierAttempts = "earlier_attempts";

// Returns a JSON list.
std::string ToJson(const EarlierAttempts& earlier);
// Reads them from an episode's metadata; empty if it has none. Throws IoError for invalid metadata.
EarlierAttempts EarlierAttemptsIn(const std::string& metadata_json);

}  // namespace robocell
