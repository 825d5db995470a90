#include "robocell/spec/scene_source_spec.h"

#include <fmt/format.h>

#include <set>

namespace robocell {

void FilesScenes::Validate(Problems& problems) const {
  if (files.empty()) problems.AddAt("files", "`source: files` needs at least one MJCF file");
}

KindRegistry& SceneSourceRegistry() {
  static KindRegistry registry(
      "scene source", "source",
      {{TabletopScenes::kKind, std::make_shared<KindFieldsOf<TabletopScenes>>()},
       {FilesScenes::kKind, std::make_shared<KindFieldsOf<FilesScenes>>()}});
  return registry;
}

void ValidateScenes(const SceneSourceSpec& scenes, Problems& problems) {
  ValidateKind(scenes, problems);
  std::set<int> seen;
  for (const int house : scenes.houses.values) {
    if (house < 0) problems.AddAt("houses", fmt::format("{} is negative", house));
    if (!seen.insert(house).second)
      problems.AddAt("houses", fmt::format("{} is listed twice", house));
  }
}

}  // namespace robocell
