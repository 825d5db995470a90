#include "robocell/scene/scene_use.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {

void SceneUse::ThrowInUse() const {
  const char* call = call_.load(std::memory_order_relaxed);
  throw Error(fmt::format(
      "{} is in use by another thread{}: a scene, with its robots, renderers and all else that "
      "belongs to it, is used by one thread at a time. Give each thread its own scene; scenes may "
      "share one model: compile_scene, then freeze(), then Scene.from_compiled in each thread "
      "(in C++ CompileScene, Freeze, Scene::FromCompiled); or let the threads take turns with a "
      "lock of yours",
      scene_, call ? fmt::format(" ({})", call) : ""));
}

}  // namespace robocell
