#include "scene_sharing.h"

#include <mujoco/mujoco.h>

#include <fmt/format.h>

#include <cstdlib>
#include <mutex>
#include <string_view>
#include <utility>

#include "python_owner.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/version.h"

namespace robocell::python {
namespace {

uintptr_t AddressOf(const void* pointer) { return reinterpret_cast<uintptr_t>(pointer); }

// One hand-over at a time: while Python makes the object, other threads may get the GIL and request
// the same model, and a second hand-over of one model would free it.
class HandOverLock {
 public:
  HandOverLock() {
    if (lock_.owns_lock()) return;
    const nb::gil_scoped_release release;
    lock_.lock();
  }

 private:
  static std::recursive_mutex& mutex() {
    static auto* mutex = new std::recursive_mutex;
    return *mutex;
  }
  std::unique_lock<std::recursive_mutex> lock_{mutex(), std::try_to_lock};
};

void HandOver(CompiledScene& compiled) {
  const nb::object take_over = ImportMujoco().attr("MjModel").attr("_from_model_ptr");
  const HandOverLock lock;
  static const CompiledScene* present = nullptr;  // guarded by the lock
  if (compiled.model_is_external()) return;       // another thread did it meanwhile
  if (present == &compiled) throw Error("the model is being handed over to Python already");
  present = &compiled;
  nb::object model;
  try {
    model = take_over(AddressOf(compiled.model()));
  } catch (...) {
    present = nullptr;
    compiled.LoseModel();  // a failure frees the model
    throw;
  }
  present = nullptr;
  compiled.AdoptModelKeeper(KeepAlive(model));
}

// Makes the arrays among an object's attributes read-only permanently: the engine's objects return
// the same array every time.
void ProtectArrays(nb::handle owner) {
  const nb::object array = nb::module_::import_("numpy").attr("ndarray");
  for (const nb::handle name : nb::steal<nb::list>(PyObject_Dir(owner.ptr()))) {
    if (nb::cast<std::string_view>(name).starts_with("_")) continue;
    const nb::object value = nb::getattr(owner, name, nb::none());
    if (nb::isinstance(value, array)) value.attr("setflags")(nb::arg("write") = false);
  }
}

void MakeReadOnly(nb::handle model) {
  const nb::object vis = model.attr("vis");
  for (const char* part : {"headlight", "rgba", "map", "scale", "quality", "global_"}) {
    ProtectArrays(vis.attr(part));
  }
  ProtectArrays(model.attr("stat"));
  ProtectArrays(model.attr("opt"));
  ProtectArrays(model);
}

// The package cannot be imported if MUJOCO_GL has an unknown value.
nb::object ImportWithAnyGl() {
  try {
    return nb::module_::import_("mujoco");
  } catch (const nb::python_error& error) {
    const char* gl = std::getenv("MUJOCO_GL");
    if (!gl || std::string_view(error.what()).find("MUJOCO_GL: ") == std::string_view::npos) throw;
    throw Error(
        fmt::format("the environment variable MUJOCO_GL is '{}', and with that the Python package "
                    "mujoco cannot be imported. It may be egl, osmesa, glfw or unset: "
                    "`unset MUJOCO_GL`, or `export MUJOCO_GL=egl`",
                    gl));
  }
}

// The package makes the engine read the clock dozens of times in every step, for MjData.timer: a
// tenth of the time of a small robot's step. A clock that a user installed is kept.
void StopEngineTimers(const nb::object& mujoco) {
  const char* wanted = std::getenv("ROBOCELL_ENGINE_TIMERS");
  if (wanted && *wanted && std::string_view(wanted) != "0") return;
  if (mujoco.attr("get_mjcb_time")().is_none()) mjcb_time = nullptr;
}

}  // namespace

nb::object ImportMujoco() {
  const nb::object mujoco = ImportWithAnyGl();
  const auto version = nb::cast<std::string>(mujoco.attr("mj_versionString")());
  if (version != CompiledEngineVersion()) {
    throw EngineError(fmt::format(
        "the Python package mujoco is version {}, robocell was built for {}. Install that one: "
        "pip install mujoco=={}",
        version, CompiledEngineVersion(), CompiledEngineVersion()));
  }
  static bool stopped = false;  // guarded by the GIL
  if (!std::exchange(stopped, true)) StopEngineTimers(mujoco);
  return mujoco;
}

nb::object ModelOf(CompiledScene& compiled) {
  if (!compiled.model_is_external()) HandOver(compiled);
  nb::object model = ObjectOf(compiled.model_keeper());
  if (!model.is_valid()) throw Error("the model is owned by something else than Python");
  if (compiled.frozen() && nb::cast<bool>(model.attr("qpos0").attr("flags").attr("writeable"))) {
    MakeReadOnly(model);
  }
  return model;
}

void Freeze(CompiledScene& compiled) {
  compiled.Freeze();
  if (compiled.model_is_external()) ModelOf(compiled);
}

nb::object DataOf(const Scene& scene) {
  nb::object data = ObjectOf(scene.data_keeper());
  if (!data.is_valid()) {
    throw Error(
        "scene '" + scene.name() +
        "' was made in C++ with data of its own, which cannot be shown as mujoco.MjData; "
        "use state() and set_state(), or build it with Scene.build. A sampler in C++ passes "
        "SampleRequest::scene_data to Scene::Build");
  }
  return data;
}

DataFactory PythonData() {
  return [](CompiledScene& compiled) -> DataHandle {
    const nb::gil_scoped_acquire gil;
    ReleaseAbandoned();
    nb::object data = ImportMujoco().attr("MjData")(ModelOf(compiled));
    auto* address = reinterpret_cast<mjData*>(nb::cast<uintptr_t>(data.attr("_address")));
    return {address, KeepAlive(std::move(data))};
  };
}

}  // namespace robocell::python
