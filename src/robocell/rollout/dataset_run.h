// The run that made a dataset, from the dataset alone: to go on with it, to evaluate a policy in its
// cell, or to make its environments where the run file is not.
//
//   RunConfig run = RunOfDataset(Dataset("out/pick_v1"));
//   run.output = "out/evaluation";
//
// Nothing is imported: kinds of a user's own are registered before.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/data/dataset.h"
#include "robocell/spec/run_config.h"

namespace robocell {

// Returns the run with the robot and the files of its scenes as the dataset keeps them, and without
// `output`, `augment` and `noise`: what is made with it goes elsewhere, by another expert or policy,
// whose actions are its own. Throws ArgumentError for a dataset without an
// episode, for one that no run made, and for one whose starts come from an unregistered sampler;
// SpecError for tasks, scene sources and features that are not registered, and for code of theirs
// that is not what the dataset was made with; IoError for episodes that were edited.
RunConfig RunOfDataset(const Dataset& dataset);

// Returns the first episode, whose metadata has the run's seed. Throws ArgumentError for a dataset
// without an episode, and for one that no run made.
Episode FirstEpisodeOfRun(const Dataset& dataset);

// Returns `scenes.houses` of the run that made a dataset; empty for all of its scenes. The report
// has them as the last command was given them. Without one, and for scenes of earlier commands, the
// episodes say which there are.
std::vector<int> HousesOfDataset(const Dataset& dataset);

// Scene and episode within it, which the id of a run's episode consists of: s0003_e0001.
struct PlanNumbers {
  int scene = 0;
  int episode = 0;

  bool operator==(const PlanNumbers&) const = default;
};
// Returns the numbers of an id, also of one of several attempts that are kept, s0003_e0001_a02.
// Unset for an id of another form.
std::optional<PlanNumbers> NumbersOfId(const std::string& id);

}  // namespace robocell
