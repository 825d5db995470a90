// Reads the source episodes of a run with `augment` as demonstrations (expert/demonstration.h).
//
//   const Demonstrations sources = ReadSources(run);
//
// An episode needs the columns robots/<robot>/tcp_pose and objects/<object>/pose, which episodes of
// runs and environments have. Bodies that joints of objects move, drawers and doors, are known of
// episodes that record their scene: their controls are played again. If that does not give the
// recorded poses, as on another machine, these bodies are left out, with a warning.
#pragma once

#include <string>
#include <vector>

#include "robocell/data/dataset.h"
#include "robocell/expert/demonstration.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns the ids of the source episodes. Throws NotFoundError for one that the dataset lacks, and
// ArgumentError if there are none.
std::vector<std::string> SourceIds(const AugmentConfig& augment);
// Reads an episode; `robot` is the name of its robot if it has several. Throws ArgumentError that
// names missing columns, and those that are no poses. Without `plays_controls` it is faster, and
// drawers and doors are left out.
Demonstration ReadDemonstration(const Episode& episode, const std::string& robot,
                                bool plays_controls = true);
// Throws what ReadSources throws, without playing the controls of all episodes.
void RequireSources(const RunConfig& run);
// Reads all source episodes of a run. Those without a segment are left out, with a warning. Throws
// ArgumentError if none remains.
Demonstrations ReadSources(const RunConfig& run);

}  // namespace robocell::internal
