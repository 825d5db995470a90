// For tests only: a scene saved as XML and loaded by the engine.
#pragma once

#include <mujoco/mujoco.h>

#include <filesystem>
#include <string>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/model_compare.h"

namespace robocell {

inline constexpr double kSixDigits = 1e-5;

// Ignores tables of paths, trees of bounding boxes (made from rounded numbers), and the intrinsics
// of cameras without a sensor size (an unused copy of znear).
inline std::string DifferencesAfterXml(const Scene& scene, const std::filesystem::path& file) {
  scene.SaveXml(file.string());
  std::filesystem::current_path("/");  // nothing may depend on the working folder
  char error[1000] = "";
  ModelPtr loaded(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
  if (!loaded) return error;
  return ModelDifferences(scene.model(), loaded.get(), kSixDigits,
                          {"paths", "npaths", "path", "mesh_pathadr", "tex_pathadr", "bvh_",
                           "nbuffer", "oct_", "cam_intrinsic"});
}

}  // namespace robocell
