// The model files that a scene's spec names: those of its base, robots, attachments, objects and
// cameras.
#pragma once

#include <string>

#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

template <class Cameras, class F>
void ForEachCameraModel(Cameras& cameras, const std::string& directory, F&& f) {
  for (auto& camera : cameras) {
    if (!camera.mjcf_path.empty()) f(camera.mjcf_path, directory);
  }
}

// Calls f(name, directory) for each, as for Resolve. If `scene` is not const, f may replace `name`.
template <class Scene, class F>
void ForEachModel(Scene& scene, F&& f) {
  if (scene.base) f(*scene.base, scene.source_dir);
  for (auto& robot : scene.robots) {
    if (robot.config) {
      auto& config = *robot.config;
      const std::string& own = config.source_dir.empty() ? scene.source_dir : config.source_dir;
      f(config.model, own);
      for (auto& attachment : config.attachments) f(attachment.mjcf_path, own);
      ForEachCameraModel(config.cameras, own, f);
    } else {
      f(robot.path, scene.source_dir);
    }
    for (auto& attachment : robot.attachments) f(attachment.mjcf_path, scene.source_dir);
  }
  for (auto& object : scene.objects) {
    if (!object.shape) f(object.mjcf_path, scene.source_dir);
  }
  ForEachCameraModel(scene.cameras, scene.source_dir, f);
}

}  // namespace robocell::internal
