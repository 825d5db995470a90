#include "robocell/scene/compiled_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <atomic>
#include <map>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/pool.h"

namespace robocell {
namespace {

template <class Record>
const Record& Find(const std::vector<Record>& records, const std::string& name, const char* kind,
                   const std::string& scene) {
  std::vector<std::string> names;
  for (const Record& record : records) {
    if (record.name == name) return record;
    names.push_back(record.name);
  }
  throw NotFoundError(NoSuchName("scene '" + scene + "'", kind, name, names));
}

// Returns the object that has a body of this name or of a near one, in words; "" if none has.
std::string PartNamed(const mjModel* m, const std::vector<ObjectRecord>& objects,
                      const std::string& name) {
  std::map<std::string, std::string> owners;
  std::vector<std::string> names, bodies;
  for (const ObjectRecord& object : objects) {
    names.push_back(object.name);
    const int root = m ? FindId(m, mjOBJ_BODY, object.root_body) : -1;
    for (int body = root; body > 0 && body < m->nbody; ++body) {
      if (!internal::IsInSubtree(m, body, root)) continue;
      bodies.push_back(ElementName(m, mjOBJ_BODY, body));
      owners.emplace(bodies.back(), object.name);
    }
  }
  if (const auto same = owners.find(name); same != owners.end())
    return fmt::format(" '{}' is a body of object '{}'", name, same->second);
  const std::vector<std::string> near = NearestNames(name, bodies, 1);
  if (near.empty() || !NearestNames(name, names, 1).empty()) return "";
  return fmt::format(" Object '{}' has a body '{}'", owners.at(near.front()), near.front());
}

}  // namespace

CompiledScene::~CompiledScene() {
  if (keeper_ && model_)
    ModelEnds(model_);  // Python may keep the model longer: nobody else may use it
}

uint64_t CompiledScene::NextGeneration() {
  static std::atomic<uint64_t> next = 1;
  return next++;
}

mjSpec* CompiledScene::mutable_spec() {
  if (origin_) return origin_->mutable_spec();
  if (!spec_owner_) spec_owner_ = std::move(CompileScene(scene_spec_)->spec_owner_);
  return spec_owner_.get();
}

std::shared_ptr<CompiledScene> CompiledScene::Copy() {
  RequireModel();
  std::shared_ptr<CompiledScene> copy(new CompiledScene);
  copy->scene_spec_ = scene_spec_;
  copy->model_owner_ = CopyModel(model_);
  copy->model_ = copy->model_owner_.get();
  copy->robots_ = robots_;
  copy->objects_ = objects_;
  copy->warnings_ = warnings_;
  copy->notes_ = notes_;
  copy->engine_guards_ = engine_guards_;
  copy->jacobian_ = jacobian_;
  copy->generation_ = NextGeneration();
  copy->home_key_ = home_key_;
  copy->key_owners_ = key_owners_;
  copy->modes_ = modes_;
  copy->sources_ = sources_;
  copy->origin_ = origin_ ? origin_ : shared_from_this();
  return copy;
}

std::vector<std::string> CompiledScene::engine_guards() const {
  // Other code may have written another Jacobian into the model since.
  const bool is_guarded = model_ && model_->opt.jacobian == mjJAC_DENSE;
  return is_guarded ? engine_guards_ : std::vector<std::string>();
}

void CompiledScene::KeepJacobian(const CompiledScene& from) {
  if (from.model()->opt.jacobian == from.jacobian_) mutable_model()->opt.jacobian = jacobian_;
}

void CompiledScene::RequireModel() const {
  if (model_) return;
  throw Error("scene '" + scene_spec_.name +
              "': its model was lost when it was to be handed over to Python; compile it again");
}

void CompiledScene::RequireSameFiles(const CompiledScene& next) const {
  const std::string changed = sources_.Difference(next.sources_);
  if (changed.empty()) return;
  throw Error("scene '" + scene_spec_.name + "': '" + changed +
              "' has changed since the scene was compiled, and objects are added and removed by "
              "compiling it again, which would change the present ones too. Build a new scene, or "
              "restore the file");
}

mjModel* CompiledScene::mutable_model() {
  RequireModel();
  if (frozen_) {
    throw Error("scene '" + scene_spec_.name +
                "': its compiled scene is frozen because it is shared between scenes; "
                "a scene that writes to the model needs its own copy: " +
                internal::CppAndPythonName("Scene::Build"));
  }
  return model_;
}

std::shared_ptr<void> CompiledScene::Claim() {
  RequireModel();
  if (!frozen_ && !claim_.expired()) {
    throw Error("scene '" + scene_spec_.name +
                "': its compiled scene is used by another scene already, and changes of the model "
                "by one would affect the other. Freeze the compiled scene to share it "
                "with " +
                internal::CppAndPythonName("Freeze") + ", or compile the spec again");
  }
  auto claim = std::make_shared<char>();
  if (frozen_) return claim;  // several threads may claim a frozen one at once
  RestoreStart();
  claim_ = claim;
  return claim;
}

std::vector<std::string> CompiledScene::DifferencesFromStart() const {
  std::vector<std::string> differences;
  for (const internal::PooledObject& object : internal::PoolOf(*this)) {
    if (object.IsAsAfterReset(model_)) continue;
    differences.push_back(fmt::format("object '{}' was {}", object.name(),
                                      object.parked_after_reset() ? "added" : "removed"));
  }
  if (modes_ && *modes_ != model_->opt.disableactuator)
    differences.emplace_back("robots were switched to other control modes");
  return differences;
}

void CompiledScene::RestoreStart() {
  for (const internal::PooledObject& object : internal::PoolOf(*this)) {
    if (!object.IsAsAfterReset(model_)) object.Switch(model_, object.parked_after_reset());
  }
  if (!modes_) modes_ = model_->opt.disableactuator;
  model_->opt.disableactuator = *modes_;
}

void CompiledScene::Freeze() {
  RequireModel();
  if (frozen_) return;
  if (claim_.expired()) {
    RestoreStart();
  } else if (const auto differences = DifferencesFromStart(); !differences.empty()) {
    throw Error(fmt::format(
        "scene '{}': its compiled scene cannot be frozen as its present scene has it, as other "
        "scenes would begin so: {}. Reset that scene and switch the modes back, or close it; or "
        "freeze before",
        scene_spec_.name, fmt::join(differences, ", ")));
  }
  frozen_ = true;
}

const RobotRecord& CompiledScene::robot(const std::string& name) const {
  return Find(robots_, name, "robot", scene_spec_.name);
}

const ObjectRecord& CompiledScene::object(const std::string& name) const {
  try {
    return Find(objects_, name, "object", scene_spec_.name);
  } catch (const NotFoundError& error) {
    throw NotFoundError(error.what() + PartNamed(model_, objects_, name));
  }
}

void CompiledScene::AdoptModelKeeper(std::shared_ptr<void> keeper) {
  if (keeper_) throw Error("scene '" + scene_spec_.name + "': its model was handed over already");
  keeper_ = std::move(keeper);
  static_cast<void>(model_owner_.release());
}

void CompiledScene::LoseModel() {
  ModelEnds(model_);
  AdoptModelKeeper(std::make_shared<char>());
  model_ = nullptr;
}

}  // namespace robocell
