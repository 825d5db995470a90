// What the disk says about the items of a plan: the one place that decides what is made and what
// is left to do. Success is counted from the disk.
//
//   const ItemOnDisk found = LookForItem(run, item);
//   if (!found.broken.empty()) ...        // name it: neither count it nor write over it
//   else if (!found.complete) runner.Run(item);
#pragma once

#include <string>
#include <vector>

#include "robocell/datagen/plan.h"

namespace robocell {

// Where an attempt is kept. With failures kept, the attempts of an item stand side by side:
// "s0003_e0001_a02".
std::string EpisodeId(const RunConfig& run, const PlanItem& item, int attempt);

struct ItemOnDisk {
  bool success = false;   // a successful episode is there
  bool complete = false;  // nothing is left to do: a success, or every attempt is used up and kept
  std::vector<std::string> broken = {};  // what stands in the way, one text each
};
ItemOnDisk LookForItem(const RunConfig& run, const PlanItem& item);

// The same of many items, by their ids.
struct PlanOnDisk {
  std::vector<std::string> made;    // items with a success
  std::vector<std::string> broken;  // texts: what stands in the way of the others
};
PlanOnDisk LookForItems(const RunConfig& run, const std::vector<PlanItem>& items);

// Whether an attempt is there, whole. IoError, with the command that sets it aside, when something
// stands in its way.
bool IsAttemptKept(const RunConfig& run, const PlanItem& item, int attempt);
// LookForItem(...).complete, with the same error.
bool IsComplete(const RunConfig& run, const PlanItem& item);

}  // namespace robocell
