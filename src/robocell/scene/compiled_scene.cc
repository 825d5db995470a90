#include "robocell/scene/compiled_scene.h"

#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/names.h"

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

CompiledScene::~CompiledScene() = default;

mjModel* CompiledScene::mutable_model() {
  if (frozen_) {
    throw Error("scene '" + scene_spec_.name +
                "': its compiled scene is frozen because it is shared between scenes; "
                "what writes to the model needs a scene of its own (Scene::Build)");
  }
  return model_;
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
