#include "robocell/task/drawn_objects.h"

namespace robocell::internal {

std::vector<DrawnObject> DrawnObjects(const Scene& scene, const TaskSetting& setting,
                                      const std::string& prefix) {
  std::vector<DrawnObject> drawn;
  for (const SceneObject& object : scene.spec().objects) {
    if (object.name.starts_with(prefix) && !setting.objects.contains(object.name))
      drawn.push_back({object.name, object.name.substr(prefix.size())});
  }
  return drawn;
}

Feature PlaceFeature(const char* name, const char* description) {
  return {.column = {.name = name,
                     .shape = {3},
                     .units = "m",
                     .frame = "shared base frame",
                     .names = {"x", "y", "z"},
                     .description = description},
          .role = FeatureRole::kPrivileged,
          .lower = std::vector<double>(3, -kFarthestObject),
          .upper = std::vector<double>(3, kFarthestObject)};
}

}  // namespace robocell::internal
