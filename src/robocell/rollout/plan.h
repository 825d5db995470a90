// Plan: the episodes of a run, a pure function of its configuration. Same file, same plan, same
// seeds, whoever runs it.
//
//   for (const PlanItem& item : Shard(MakePlan(run), 0, 8)) runner.Run(item);
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/run_config.h"

namespace robocell {

// One episode to be made. The episode is the first success among its attempts 0, 1, 2, ...
struct PlanItem {
  int index = 0;    // in the plan
  int scene = 0;    // which scene of the source
  int episode = 0;  // which episode in that scene
  std::string id;   // name of the episode's folder: "s0003_e0001"
};

// `episodes` items, else `episodes_per_scene` for each scene. The scenes take turns, in order of
// `scenes.houses`, so that few episodes still visit many of them. More scenes or episodes extend a
// plan: the ids and seeds of the others stay. SpecError for more than ten million episodes.
std::vector<PlanItem> MakePlan(const RunConfig& run);

// The items with index % count == shard. ArgumentError unless 0 <= shard < count.
std::vector<PlanItem> Shard(const std::vector<PlanItem>& plan, int shard, int count);
// "i/N" as on the command line.
struct ShardSpec {
  int shard = 0;
  int count = 1;
};
ShardSpec ParseShard(const std::string& text);

// The random stream of one attempt, for one purpose ("start", "expert", ...).
Rng AttemptStream(const RunConfig& run, const PlanItem& item, int attempt,
                  const std::string& purpose);

// What identifies a run: its fields without workers and output, as YAML with the robot in place.
// Two runs with the same identity make the same episodes; a dataset refuses to go on under another
// one.
std::string RunIdentity(const RunConfig& run);

}  // namespace robocell
