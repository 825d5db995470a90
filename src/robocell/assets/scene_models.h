// The model files that a scene's spec names: of its base, robots, attachments and objects.
#pragma once

#include <string>

#include "robocell/spec/scene_spec.h"

namespace robocell::assets {

// Calls f(name, directory) for each, as for Resolve. When `scene` is not const, `name` may be
// replaced.
template <class Scene, class F>
void ForEachModel(Scene& scene, F&& f) {
  if (scene.base) f(*scene.base, scene.source_dir);
  for (auto& robot : scene.robots) {
    if (robot.config) {
      auto& config = *robot.config;
      const std::string& own = config.source_dir.empty() ? scene.source_dir : config.source_dir;
      f(config.model, own);
      for (auto& attachment : config.attachments) f(attachment.mjcf_path, own);
    } else {
      f(robot.path, scene.source_dir);
    }
    for (auto& attachment : robot.attachments) f(attachment.mjcf_path, scene.source_dir);
  }
  for (auto& object : scene.objects) {
    if (!object.shape) f(object.mjcf_path, scene.source_dir);
  }
}

}  // namespace robocell::assets
