#include "robocell/spec/scene_source_spec.h"

#include <fmt/format.h>

#include <set>

namespace robocell {

void FilesScenes::Validate(Problems& problems) const {
  if (files.empty()) problems.AddAt("files", "`source: files` needs at least one MJCF file");
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
