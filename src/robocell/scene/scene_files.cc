// Saving a Scene.
#include <mujoco/mujoco.h>

#include <mutex>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/scene/carry_over.h"
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

// What is parked is left out; what is there of the pool is an object as any other.
std::shared_ptr<CompiledScene> Scene::State::WithoutPool() {
  SceneSpec spec = compiled->spec();
  std::erase_if(spec.objects.boxes(), [&](const auto& object) {
    const PooledObject* pooled = FindPooled(object->name);
    return pooled && pooled->parked;
  });
  for (SceneObject& object : spec.objects) object.parked.reset();
  std::shared_ptr<CompiledScene> there = CompileScene(spec);
  CarryModel(ElementMatch(model(), there->model()), there->mutable_model());
  return there;
}

std::string Scene::ToXml() const {
  State& s = open();
  const std::lock_guard lock(saving);
  const std::shared_ptr<CompiledScene> there = s.pool.empty() ? s.compiled : s.WithoutPool();
  return SaveXmlString(UpToDateSpec(*there, s.context), s.context);
}

void Scene::SaveXml(const std::string& path) const {
  State& s = open();
  const std::lock_guard lock(saving);
  const std::shared_ptr<CompiledScene> there = s.pool.empty() ? s.compiled : s.WithoutPool();
  robocell::SaveXml(UpToDateSpec(*there, s.context), path, s.context);
}

void Scene::SaveBinary(const std::string& path) const {
  const State& s = open();
  robocell::SaveBinary(s.model(), path, s.context);
}

}  // namespace robocell
