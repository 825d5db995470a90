// Private to scene: objects, as primitives or separate models.
#pragma once

#include <optional>

#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part.h"
#include "robocell/scene/placement.h"

namespace robocell::internal {

// Loads an object's model, names the elements that need a name, and adds or removes its free joint.
// A primitive becomes a model too, so that both are attached in the same way. Null if there were
// problems.
struct ObjectPart {
  Part part;
  mjsBody* root = nullptr;
  std::string prefix;  // prefix of the model's names in the scene
  ObjectRecord record;
};
std::optional<ObjectPart> LoadObject(const SceneObject& object, const SceneSpec& scene,
                                     CompileLog& log);

void AttachObject(const SceneObject& object, ObjectPart& loaded, const Placement& placement,
                  CompileLog& log);

}  // namespace robocell::internal
