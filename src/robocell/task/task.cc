#include "robocell/task/task.h"

#include "robocell/base/error.h"

namespace robocell {

const SceneAnnotations& Task::annotations() const {
  if (!annotations_) {
    if (!known_scene_)
      throw Error(
          "annotations of a scene are asked for in prepare() first; keep there what is needed "
          "later");
    annotations_ = (*known_scene_)();
  }
  return *annotations_;
}

void Task::PrepareIn(const KnownScene& known, SceneSpec& spec, Rng& rng) {
  struct Preparing {
    Task& task;
    ~Preparing() { task.known_scene_ = nullptr; }
  } const preparing{*this};
  annotations_.reset();
  known_scene_ = &known;
  Prepare(spec, rng);
}

}  // namespace robocell
