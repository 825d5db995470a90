// Plan: the episodes of a run, a pure function of its configuration. The same file gives the same
// plan and the same seeds in every process.
//
//   for (const PlanItem& item : Shard(MakePlan(run), 0, 8)) runner.Run(item);
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/run_config.h"

namespace robocell {

// An episode to be made: the first success among its attempts first_attempt, first_attempt + 1, ...
struct PlanItem {
  int index = 0;    // index in the plan
  int scene = 0;    // number of the scene in the source
  int episode = 0;  // number of the episode in that scene
  std::string id;   // name of the episode's folder: "s0003_e0001"
  // Above 0 to make a recorded episode again from its own start: earlier attempts are left out.
  int first_attempt = 0;
};

// Returns `episodes` items, else `episodes_per_scene` for each scene. The scenes take turns, in the
// order of `scenes.houses`, so that few episodes still visit many scenes. More scenes or episodes
// extend a plan: the ids and seeds of the others stay. Throws SpecError for more than ten million
// episodes.
std::vector<PlanItem> MakePlan(const RunConfig& run);

// Returns the items with index % count == shard. Throws ArgumentError unless 0 <= shard < count.
std::vector<PlanItem> Shard(const std::vector<PlanItem>& plan, int shard, int count);
// A shard, written "i/N" on the command line.
struct ShardSpec {
  int shard = 0;
  int count = 1;
};
ShardSpec ParseShard(const std::string& text);

// Returns the random stream of one attempt for one purpose ("start", "expert", ...).
Rng AttemptStream(const RunConfig& run, const PlanItem& item, int attempt,
                  const std::string& purpose);

// Returns the identity of a run: its fields without workers, output and render, as YAML with the
// robot's file inserted. Two runs with the same identity make the same episodes; a dataset refuses
// runs with another one.
std::string RunIdentity(const RunConfig& run);

}  // namespace robocell
