// Saving a Scene.
#include <mujoco/mujoco.h>

#include <mutex>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

// Saving touches the spec, which frozen scenes share.
std::mutex saving;

// Takes changes that were made to the model (colours, masses, gains, keyframes, ...) into the spec.
mjSpec* UpToDateSpec(CompiledScene& compiled, const std::string& context) {
  mjSpec* spec = compiled.mutable_spec();
  const mjModel* model = compiled.model();
  if (!Guarded(context, [&] { return mj_copyBack(spec, model); })) {
    throw EngineError(
        context +
        ": the model was changed in a way that XML cannot hold; SaveBinary can. MuJoCo: " +
        mjs_getError(spec));
  }
  return spec;
}

}  // namespace

std::string Scene::ToXml() const {
  State& s = open();
  const std::lock_guard lock(saving);
  return SaveXmlString(UpToDateSpec(*s.compiled, s.context), s.context);
}

void Scene::SaveXml(const std::string& path) const {
  State& s = open();
  const std::lock_guard lock(saving);
  robocell::SaveXml(UpToDateSpec(*s.compiled, s.context), path, s.context);
}

void Scene::SaveBinary(const std::string& path) const {
  const State& s = open();
  robocell::SaveBinary(s.model(), path, s.context);
}

}  // namespace robocell
