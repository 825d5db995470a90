// The kinds of tasks pick and pick_and_place, for the registry of kinds (task_kind.h): the rules of
// their fields in runs and environments, and what a run's scenes may hold.
#pragma once

#include <memory>

#include "robocell/task/task_kind.h"

namespace robocell::internal {

std::shared_ptr<const TaskKind> MakePickKind();
std::shared_ptr<const TaskKind> MakePickAndPlaceKind();

}  // namespace robocell::internal
