// Adds and removes objects of a running scene.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/step.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/carry_over.h"
#include "robocell/scene/placement.h"
#include "robocell/scene/scene_state.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

// --- Elements attached to an object --------------------------------------------------------------

// The model does not contain frames.
bool IsFrameIn(CompiledScene& compiled, const std::string& frame, const std::string& root_body) {
  mjsElement* element = internal::FindSpecElement(compiled.mutable_spec(), mjOBJ_FRAME, frame);
  if (!element) return false;
  for (mjsBody* body = mjs_getParent(element); body; body = mjs_getParent(body->element)) {
    if (internal::SpecName(body->element) == root_body) return true;
  }
  return false;
}

// Returns true if a target is part of the object that begins at `root_body`.
bool IsPartOf(CompiledScene& compiled, const AttachTarget& target, const std::string& root_body) {
  const mjModel* m = compiled.model();
  const int root = FindId(m, mjOBJ_BODY, root_body);
  if (target.kind == AttachKind::kBody) {
    const int body = FindId(m, mjOBJ_BODY, target.name);
    return body >= 0 && internal::IsInSubtree(m, body, root);
  }
  if (target.kind == AttachKind::kSite) {
    const int site = FindId(m, mjOBJ_SITE, target.name);
    return site >= 0 && internal::IsInSubtree(m, m->site_bodyid[site], root);
  }
  return target.kind == AttachKind::kFrame && IsFrameIn(compiled, target.name, root_body);
}

// Returns "object 'cup' (to site 'table_top')" for everything that would lose its support.
std::vector<std::string> AttachedTo(CompiledScene& compiled, const std::string& object) {
  const std::string& root = compiled.object(object).root_body;
  std::vector<std::string> attached;
  const auto look = [&](const std::string& what, const AttachTarget& target) {
    if (IsPartOf(compiled, target, root))
      attached.push_back(fmt::format("{} (to {})", what, internal::DescribeTarget(target)));
  };
  const SceneSpec& spec = compiled.spec();
  for (const SceneObject& other : spec.objects) {
    if (other.name != object) look("object '" + other.name + "'", other.attach_to);
  }
  for (size_t i = 0; i < spec.robots.size(); ++i)
    look("robot '" + compiled.robots()[i].name + "'", spec.robots[i].attach_to);
  for (const CameraSpec& camera : spec.cameras)
    look("camera '" + camera.name + "'", camera.attach_to);
  return attached;
}

void RequireNothingAttached(CompiledScene& compiled, const std::string& object,
                            const std::string& context) {
  const std::vector<std::string> attached = AttachedTo(compiled, object);
  if (attached.empty()) return;
  throw ArgumentError(fmt::format(
      "{}: object '{}' cannot be removed: attached to it {} {}. Remove objects that hang on it "
      "first; robots and cameras stay where they are, build another scene without them",
      context, object, attached.size() == 1 ? "is" : "are", ListNames(attached)));
}

// --- Spec and model ------------------------------------------------------------------------------

std::vector<std::string> NamesOf(const SceneSpec& spec) {
  std::vector<std::string> names;
  for (const SceneObject& object : spec.objects) names.push_back(object.name);
  return names;
}

}  // namespace

void Scene::AddObject(const SceneObject& object) {
  State& s = open();
  if (s.FindPooled(object.name)) return AddPooled(object);
  SceneSpec spec = s.compiled->spec();
  const std::vector<std::string> names = NamesOf(spec);
  if (std::find(names.begin(), names.end(), object.name) != names.end()) {
    throw ArgumentError(
        fmt::format("{}: there is an object '{}' already; remove it first, or choose another name. "
                    "The objects: {}",
                    s.context, object.name, ListNames(names)));
  }
  s.RequireOwnModel("added", object.name);
  RequireValid(object,
               fmt::format("{}: the object '{}' given to add_object", s.context, object.name));
  spec.objects.push_back(object);
  Rebuild(spec);
}

void Scene::RemoveObject(const std::string& name) {
  const State& s = open();
  if (RemovePooled(name)) return;
  static_cast<void>(s.compiled->object(name));  // throws with the existing names
  s.RequireOwnModel("removed", name);
  RequireNothingAttached(*s.compiled, name, s.context);
  SceneSpec spec = s.compiled->spec();
  std::erase_if(spec.objects.boxes(), [&](const auto& object) { return object->name == name; });
  spec.locations = {};  // the indices of later objects would be wrong
  Rebuild(spec);
}

void Scene::Rebuild(const SceneSpec& spec) {
  State& s = open();
  std::shared_ptr<CompiledScene> compiled = CompileScene(spec);
  s.compiled->RequireSameFiles(*compiled);
  std::shared_ptr<void> claim = compiled->Claim();
  const internal::ElementMatch match(s.model(), compiled->model());
  internal::CarryModel(match, compiled->mutable_model());
  compiled->KeepJacobian(*s.compiled);
  DataHandle data = s.factory(*compiled);
  // New elements start as after a reset.
  internal::Guarded(s.context, data.data, [&, m = compiled->model(), key = compiled->home_key()] {
    mj_resetDataKeyframe(m, data.data, key);
  });
  internal::CarryState(match, s.data.data, data.data);
  robocell::Forward(compiled->model(), data.data, s.context);
  internal::CarryState(match, s.data.data,
                       data.data);  // the forward pass leaves its own warm start

  std::vector<internal::PooledObject> pool = internal::PoolOf(*compiled);
  for (internal::PooledObject& object : pool) {
    if (const internal::PooledObject* known = s.FindPooled(object.name()))
      object.parked = known->parked;
  }
  const auto swap = [&] {
    s.pool.swap(pool);
    s.warm_start.resize(static_cast<size_t>(compiled->model()->nv));
    s.compiled.swap(compiled);
    s.claim.swap(claim);
    std::swap(s.data, data);
    s.poses_at = -1;
    s.Show();
  };
  swap();
  const auto observers = s.observers;
  const auto notify = [&] {
    for (const auto& watch : observers) {
      if (const auto observer = watch.observer.lock()) observer->OnRebuild();
      open();
    }
  };
  try {
    notify();
  } catch (...) {
    if (s.closed) throw;
    swap();
    for (const auto& watch : observers) {
      try {
        if (const auto observer = watch.observer.lock()) observer->OnRebuild();
      } catch (const std::exception&) {  // an observer that fails does not stop the others
      }
      if (s.closed) break;
    }
    throw;
  }
}

}  // namespace robocell
