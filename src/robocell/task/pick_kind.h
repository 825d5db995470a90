// The kind of task `pick`, for the registry of kinds (task_kind.h).
#pragma once

#include <memory>

namespace robocell {

class TaskKind;

std::shared_ptr<const TaskKind> MakePickKind();

}  // namespace robocell
