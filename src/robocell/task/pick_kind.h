// The kinds of tasks `pick` and `pick_and_place`, for the registry of kinds (task_kind.h).
#pragma once

#include <memory>

namespace robocell {

class TaskKind;

std::shared_ptr<const TaskKind> MakePickKind();
std::shared_ptr<const TaskKind> MakePickAndPlaceKind();

}  // namespace robocell
