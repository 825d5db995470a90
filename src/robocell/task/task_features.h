// All features of a cell with a task: those of the scene, the robots and registered features, and
// the task's signals as `task/<signal>`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/features/cell_features.h"
#include "robocell/task/task.h"

namespace robocell {

// Returns the objects that a bound task names. Throws HookError for one that the scene does not
// have and for one that is named twice.
std::vector<std::string> ObjectsOf(const Task& task, const Scene& scene);

// `task`: bound to the scene; null for a cell without one. `own`: registered features.
CellFeatures FeaturesOfCell(const Scene& scene, const std::vector<Robot>& robots,
                            std::shared_ptr<const Task> task, const std::vector<std::string>& own);

}  // namespace robocell
