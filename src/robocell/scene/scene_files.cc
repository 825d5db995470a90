// Saving a Scene.
#include <mujoco/mujoco.h>

#include <mutex>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/scene/carry_over.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

// Saving modifies the spec, which frozen scenes share.
std::mutex saving;

// Copies changes that were made to the model (colours, masses, gains, keyframes, ...) into the
// spec.
mjSpec* UpToDateSpec(CompiledScene& compiled, const std::string& context) {
  mjSpec* spec = compiled.mutable_spec();
  const mjModel* model = compiled.model();
  if (!internal::Tried(context, [&] { return mj_copyBack(spec, model); })) {
    throw EngineError(context +
                      ": the model was changed in a way that XML cannot hold; save it with " +
                      internal::CppAndPythonName("SaveBinary") + ". MuJoCo: " + mjs_getError(spec));
  }
  return spec;
}

bool WeighsNothing(const mjsElement* element) {
  const mjsGeom* geom = mjs_asGeom(const_cast<mjsElement*>(element));
  return geom && (geom->mass == 0 || geom->density == 0);
}

// Returns bodies whose inertia comes from geoms, some of which have no mass.
std::vector<mjsBody*> WithWeightlessGeoms(mjSpec* spec) {
  std::vector<mjsBody*> bodies;
  for (mjsElement* e = mjs_firstElement(spec, mjOBJ_BODY); e; e = mjs_nextElement(spec, e)) {
    mjsBody* body = mjs_asBody(e);
    if (body->explicitinertial || mjs_getId(e) == 0) continue;
    for (mjsElement* g = mjs_firstChild(body, mjOBJ_GEOM, 0); g; g = mjs_nextChild(body, g, 0)) {
      if (!WeighsNothing(g)) continue;
      bodies.push_back(body);
      break;
    }
  }
  return bodies;
}

// The spec as it is written. The engine's writer does not write that a class of geoms has no mass,
// so the inertia of such bodies is written as numbers.
class Writable {
 public:
  Writable(mjSpec* spec, const mjModel* model, const std::string& context) : spec_(spec) {
    if (WithWeightlessGeoms(spec).empty()) return;
    copy_ = CopySpec(spec);
    spec_ = copy_.get();
    for (mjsBody* body : WithWeightlessGeoms(spec_)) {
      const int id = mjs_getId(body->element);
      body->explicitinertial = 1;
      body->mass = model->body_mass[id];
      mju_copy3(body->ipos, model->body_ipos + 3 * id);
      mju_copy4(body->iquat, model->body_iquat + 4 * id);
      mju_copy3(body->inertia, model->body_inertia + 3 * id);
    }
    Compile(spec_, nullptr, context, nullptr,
            JacobianGuard::kOff);  // writes what was compiled
  }
  mjSpec* get() const { return spec_; }

 private:
  SpecPtr copy_;
  mjSpec* spec_;
};

}  // namespace

// Parked objects are left out; the others of the pool become ordinary objects.
std::shared_ptr<CompiledScene> Scene::State::WithoutPool() {
  SceneSpec spec = compiled->spec();
  std::erase_if(spec.objects.boxes(), [&](const auto& object) {
    const internal::PooledObject* pooled = FindPooled(object->name);
    return pooled && pooled->parked;
  });
  for (SceneObject& object : spec.objects) object.parked.reset();
  std::shared_ptr<CompiledScene> there = CompileScene(spec);
  internal::CarryModel(internal::ElementMatch(model(), there->model()), there->mutable_model());
  there->KeepJacobian(*compiled);
  return there;
}

std::string Scene::ToXml() const {
  State& s = open();
  const std::lock_guard lock(saving);
  const std::shared_ptr<CompiledScene> there = s.pool.empty() ? s.compiled : s.WithoutPool();
  mjSpec* spec = UpToDateSpec(*there, s.context);
  return SaveXmlString(Writable(spec, there->model(), s.context).get(), s.context);
}

void Scene::SaveXml(const std::string& path) const {
  State& s = open();
  const std::lock_guard lock(saving);
  const std::shared_ptr<CompiledScene> there = s.pool.empty() ? s.compiled : s.WithoutPool();
  mjSpec* spec = UpToDateSpec(*there, s.context);
  robocell::SaveXml(Writable(spec, there->model(), s.context).get(), path, s.context);
}

void Scene::SaveBinary(const std::string& path) const {
  const State& s = open();
  robocell::SaveBinary(s.model(), path, s.context);
}

}  // namespace robocell
