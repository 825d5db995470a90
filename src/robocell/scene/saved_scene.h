// Restores a scene from a file of Scene::SaveXml, perhaps changed by hand or by another program
// since: robots and objects are those of the spec, the model is the file's.
//
//   scene.SaveXml("cell.xml");  // ... change masses, add a light ...
//   Scene again = Scene::FromCompiled(CompileSavedScene(spec, "cell.xml"));
#pragma once

#include <memory>
#include <string>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Throws the errors of CompileScene for the spec, IoError and SpecError for the file, and
// NotFoundError that names the elements of the spec's scene that the file lacks or has as another
// kind.
std::shared_ptr<CompiledScene> CompileSavedScene(const SceneSpec& spec, const std::string& path);

// Checks for CompileSavedScene that `saved` has the named bodies, joints, sites, cameras and
// actuators of `built`, with joints of the same kinds, and its home key.
void RequireSavedNames(const mjModel* built, const mjModel* saved, const std::string& place);

}  // namespace robocell::internal
