// The objects that a task draws in a scene that serves all starts (Task::is_prepared_once): Prepare
// names them by their kinds, and the task that is bound to the scene finds them by these names.
#pragma once

#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task.h"

namespace robocell::internal {

inline constexpr const char* kTargetPrefix = "target_";
inline constexpr const char* kGoalPrefix = "goal_";

struct DrawnObject {
  std::string name, kind;
};
// Returns the objects of a scene with that prefix that the setting does not have itself.
std::vector<DrawnObject> DrawnObjects(const Scene& scene, const TaskSetting& setting,
                                      const std::string& prefix);

// Returns a feature of a place, x y z in the shared base frame.
Feature PlaceFeature(const char* name, const char* description);

}  // namespace robocell::internal
