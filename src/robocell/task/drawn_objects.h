// The objects that a task draws in a scene that serves all starts (Task::is_prepared_once): Prepare
// names them by their kinds, and the task that is bound to the scene finds them by these names. The
// object of a single kind has the name of a run's, so that both have the same columns.
#pragma once

#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task.h"

namespace robocell::internal {

// Names of the objects in runs.
inline constexpr const char* kTarget = "target";
inline constexpr const char* kGoal = "goal";

struct DrawnObject {
  std::string name, kind;
};
// Returns the name of an object in a scene that serves all starts: "target_mug", or "target" if
// `kinds`, those that the task's fields name, are one. `part`: kTarget or kGoal.
std::string NameOfDrawn(const std::string& part, const std::string& kind,
                        const std::vector<std::string>& kinds);
// Returns the objects of a scene with such names that the setting does not have itself.
std::vector<DrawnObject> DrawnObjects(const Scene& scene, const TaskSetting& setting,
                                      const std::string& part,
                                      const std::vector<std::string>& kinds);

// Returns a feature of a place, x y z in the shared base frame.
Feature PlaceFeature(const char* name, const char* description);

}  // namespace robocell::internal
