#include "robocell/task/drawn_objects.h"

namespace robocell::internal {

std::string NameOfDrawn(const std::string& part, const std::string& kind,
                        const std::vector<std::string>& kinds) {
  return kinds == std::vector<std::string>{kind} ? part : part + "_" + kind;
}

std::vector<DrawnObject> DrawnObjects(const Scene& scene, const TaskSetting& setting,
                                      const std::string& part,
                                      const std::vector<std::string>& kinds) {
  const std::string prefix = part + "_";
  std::vector<DrawnObject> drawn;
  for (const SceneObject& object : scene.spec().objects) {
    if (setting.objects.contains(object.name)) continue;
    if (object.name.starts_with(prefix))
      drawn.push_back({object.name, object.name.substr(prefix.size())});
    else if (object.name == part && kinds.size() == 1)
      drawn.push_back({part, kinds.front()});
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
