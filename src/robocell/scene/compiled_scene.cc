#include "robocell/scene/compiled_scene.h"

#include <mujoco/mujoco.h>

#include <atomic>

#include "robocell/base/both_languages.h"
#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/mujoco/model_watch.h"

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

}  // namespace

CompiledScene::~CompiledScene() {
  if (keeper_) ModelEnds(model_);  // Python may keep the model longer: nobody else may count on it
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
  std::shared_ptr<CompiledScene> copy(new CompiledScene);
  copy->scene_spec_ = scene_spec_;
  copy->model_owner_ = CopyModel(model_);
  copy->model_ = copy->model_owner_.get();
  copy->robots_ = robots_;
  copy->objects_ = objects_;
  copy->warnings_ = warnings_;
  copy->notes_ = notes_;
  copy->generation_ = NextGeneration();
  copy->home_key_ = home_key_;
  copy->origin_ = origin_ ? origin_ : shared_from_this();
  return copy;
}

mjModel* CompiledScene::mutable_model() {
  if (frozen_) {
    throw Error("scene '" + scene_spec_.name +
                "': its compiled scene is frozen because it is shared between scenes; "
                "what writes to the model needs a scene of its own: " +
                InBothLanguages("Scene::Build"));
  }
  return model_;
}

std::shared_ptr<void> CompiledScene::Claim() {
  if (!frozen_ && !claim_.expired()) {
    throw Error("scene '" + scene_spec_.name +
                "': its compiled scene is used by another scene already, and what one of them "
                "writes to the model would change the other. Freeze the compiled scene to share it "
                "with " +
                InBothLanguages("Freeze") + ", or compile the spec again");
  }
  auto claim = std::make_shared<char>();
  if (!frozen_) claim_ = claim;  // frozen ones may be claimed by several threads at once
  return claim;
}

const RobotRecord& CompiledScene::robot(const std::string& name) const {
  return Find(robots_, name, "robot", scene_spec_.name);
}

const ObjectRecord& CompiledScene::object(const std::string& name) const {
  return Find(objects_, name, "object", scene_spec_.name);
}

void CompiledScene::AdoptModelKeeper(std::shared_ptr<void> keeper) {
  if (keeper_) throw Error("scene '" + scene_spec_.name + "': its model was handed over already");
  keeper_ = std::move(keeper);
  static_cast<void>(model_owner_.release());
}

}  // namespace robocell
