// Adds and removes objects of the pool.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/placement.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

Pose FrameInWorld(const SceneSpec& spec, const AttachTarget& target, const std::string& place) {
  if (target.kind == AttachKind::kWorld) return Pose();
  if (target.kind == AttachKind::kRoot) return internal::RootFrameToWorld(spec);
  if (target.kind == AttachKind::kSharedBase) return internal::SharedBaseFrameToWorld(spec);
  throw ArgumentError(fmt::format("{} can move freely, so it cannot be attached to {}", place,
                                  internal::DescribeTarget(target)));
}

// Returns the same object at another place.
SceneObject PlacedLike(SceneObject object, const SceneObject& other) {
  object.attach_to = other.attach_to;
  object.pos = other.pos;
  object.euler = other.euler;
  object.quat = other.quat;
  object.parked = other.parked;
  return object;
}

// Returns where an object of the pool stands if `wanted` differs from the spec in its place.
std::optional<Pose> PoseOf(const SceneSpec& spec, const SceneObject& known,
                           const SceneObject& wanted, const mjtNum* home,
                           const std::string& place) {
  SceneObject at_home = wanted;
  at_home.parked = known.parked;
  if (at_home == known) return std::nullopt;  // equals the model
  const Pose declared = FrameInWorld(spec, known.attach_to, place) * known.pose();
  const Pose authored = declared.inverse() * Pose::FromWxyz(home, home + 3);
  return FrameInWorld(spec, wanted.attach_to, place) * wanted.pose() * authored;
}

}  // namespace

internal::PooledObject* Scene::State::FindPooled(const std::string& object) {
  for (internal::PooledObject& pooled : pool) {
    if (pooled.name() == object) return &pooled;
  }
  return nullptr;
}

void Scene::State::BindPool() {
  pool = internal::PoolOf(*compiled);
  warm_start.resize(static_cast<size_t>(compiled->model()->nv));
}

void Scene::State::RequireOwnModel(const char* what, const std::string& object) const {
  if (!compiled->frozen()) return;
  throw Error(fmt::format(
      "{}: object '{}' cannot be {}: the compiled scene is frozen because it is shared between "
      "scenes. Build a separate scene with {}, or change the spec and compile it again",
      context, object, what, internal::CppAndPythonName("Scene::Build")));
}

void Scene::Swap(internal::PooledObject& object, bool park, const mjtNum* pos) {
  State& s = open();
  mjData* d = s.data.data;
  object.Switch(s.compiled->mutable_model(), park);
  object.Put(s.model(), d, s.compiled->home_key(), pos);
  object.parked = park;
  std::copy_n(d->qacc_warmstart, s.model()->nv, s.warm_start.data());
  Forward();
  std::copy_n(s.warm_start.data(), s.model()->nv, d->qacc_warmstart);
}

void Scene::AddObject(const std::string& name, const std::optional<Pose>& pose_in_world) {
  State& s = open();
  internal::PooledObject* object = s.FindPooled(name);
  if (!object) {
    throw NotFoundError(NoSuchName(s.context + " / pool", "object", name, parked_objects()) +
                        " Declare it with `parked` in the scene's spec, or give a SceneObject");
  }
  if (!object->parked) {
    throw ArgumentError(
        fmt::format("{}: object '{}' is in the scene already; move it with {}, or remove it first",
                    s.context, name, internal::CppAndPythonName("SetBodyPose")));
  }
  s.RequireOwnModel("added", name);
  internal::FreeJointPos pos;
  std::copy_n(object->home(s.model()), 7, pos.begin());
  if (pose_in_world) pose_in_world->ToWxyz(pos.data(), pos.data() + 3);
  Swap(*object, false, pos.data());
}

void Scene::AddPooled(const SceneObject& object) {
  State& s = open();
  const SceneSpec& spec = s.compiled->spec();
  const auto known = std::find_if(spec.objects.boxes().begin(), spec.objects.boxes().end(),
                                  [&](const auto& o) { return o->name == object.name; });
  if (!(PlacedLike(object, **known) == **known)) {
    throw ArgumentError(fmt::format(
        "{}: the pool has another object '{}'; only its pose may differ from the spec's. Give the "
        "new one another name",
        s.context, object.name));
  }
  AddObject(object.name, PoseOf(spec, **known, object, s.FindPooled(object.name)->home(s.model()),
                                fmt::format("{}: object '{}'", s.context, object.name)));
}

bool Scene::RemovePooled(const std::string& name) {
  State& s = open();
  internal::PooledObject* object = s.FindPooled(name);
  if (!object) return false;
  if (object->parked) {
    throw NotFoundError(
        fmt::format("{}: object '{}' is parked, not in the scene. Objects in it: {}", s.context,
                    name, ListNames(object_names())));
  }
  s.RequireOwnModel("removed", name);
  Swap(*object, true, object->parking_place().data());
  return true;
}

std::vector<std::string> Scene::object_names() const {
  State& s = open();
  std::vector<std::string> names;
  for (const ObjectRecord& object : s.compiled->objects()) {
    const internal::PooledObject* pooled = s.FindPooled(object.name);
    if (!pooled || !pooled->parked) names.push_back(object.name);
  }
  return names;
}

std::vector<std::string> Scene::parked_objects() const {
  std::vector<std::string> names;
  for (const internal::PooledObject& object : open().pool) {
    if (object.parked) names.push_back(object.name());
  }
  return names;
}

void Scene::State::ResetPool() {
  for (internal::PooledObject& object : pool) {
    if (object.parked != object.parked_after_reset()) {
      object.parked = object.parked_after_reset();
      object.Switch(compiled->mutable_model(), object.parked);
    }
    if (object.parked)  // whatever was restored
      object.Put(model(), data.data, compiled->home_key(), object.parking_place().data());
  }
}

void Scene::State::FollowPool(const mjtNum* qpos) {
  for (internal::PooledObject& object : pool) {
    const bool parked = object.IsParkedAt(qpos);
    if (parked == object.parked) continue;
    RequireOwnModel(parked ? "removed by this state" : "added by this state", object.name());
    object.Switch(compiled->mutable_model(), parked);
    object.parked = parked;
  }
}

}  // namespace robocell
