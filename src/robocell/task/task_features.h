// All features of a cell with a task: those of the scene, the robots and registered features, and
// the task's signals as `task/<signal>`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/features/cell_features.h"
#include "robocell/task/task.h"

namespace robocell {

// Returns the names under which a bound task observes objects. Throws HookError for one that stands
// for no object of the scene and for one that is there twice.
std::vector<std::string> ObjectsOf(const Task& task, const Scene& scene);
// Returns a function of the objects for which these names stand (Task::object_of), which throws
// HookError if the scene has no such object. Null without a task.
ObjectOfName ObjectOfNameIn(std::shared_ptr<const Task> task);

// `task`: bound to the scene; null for a cell without one. `own`: registered features.
CellFeatures FeaturesOfCell(const Scene& scene, const std::vector<Robot>& robots,
                            std::shared_ptr<const Task> task, const std::vector<std::string>& own);

}  // namespace robocell
