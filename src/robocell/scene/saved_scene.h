// A scene from the file that Scene::SaveXml wrote of it, perhaps changed by hand or by another
// program since: robots and objects are those of the spec, the model is the file's.
//
//   scene.SaveXml("cell.xml");  // ... change masses, add a light ...
//   Scene again = Scene::FromCompiled(CompileSavedScene(spec, "cell.xml"));
#pragma once

#include <memory>
#include <string>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Errors: those of CompileScene for the spec; IoError and SpecError for the file; NotFoundError
// names what the spec's scene has and the file has not, or as something else.
std::shared_ptr<CompiledScene> CompileSavedScene(const SceneSpec& spec, const std::string& path);

// For CompileSavedScene: whether `saved` has the named bodies, joints, sites, cameras and actuators
// of `built`, with joints of the same kinds, and its home key.
void RequireSavedNames(const mjModel* built, const mjModel* saved, const std::string& place);

}  // namespace robocell::internal
