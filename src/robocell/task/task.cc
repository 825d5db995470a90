#include "robocell/task/task.h"

#include <memory>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"

namespace robocell {

const SceneAnnotations& Task::annotations() const {
  if (!annotations_) {
    if (!known_scene_)
      throw Error(
          "read the annotations of a scene in prepare() first, and keep there what is needed "
          "later");
    annotations_ = (*known_scene_)();
  }
  return *annotations_;
}

BaseRange SoundBaseRange(const Task& task) {
  return internal::CallHook(task, "base_range", [&] {
    const BaseRange range = task.base_range();
    RequireSound(range);
    return range;
  });
}

}  // namespace robocell
