#include "scene_sharing.h"

#include <mujoco/mujoco.h>

#include <fmt/format.h>

#include "python_owner.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/version.h"

namespace robocell::python {
namespace {

uintptr_t AddressOf(const void* pointer) { return reinterpret_cast<uintptr_t>(pointer); }

}  // namespace

nb::object ImportMujoco() {
  const nb::object mujoco = nb::module_::import_("mujoco");
  const auto version = nb::cast<std::string>(mujoco.attr("mj_versionString")());
  if (version != CompiledEngineVersion()) {
    throw EngineError(fmt::format(
        "the Python package mujoco is version {}, robocell was built for {}. Install that one: "
        "pip install mujoco=={}",
        version, CompiledEngineVersion(), CompiledEngineVersion()));
  }
  return mujoco;
}

nb::object ModelOf(CompiledScene& compiled) {
  if (compiled.model_is_external()) {
    nb::object model = ObjectOf(compiled.model_keeper());
    if (!model.is_valid()) throw Error("the model is owned by something else than Python");
    return model;
  }
  const nb::object take_over = ImportMujoco().attr("MjModel").attr("_from_model_ptr");
  nb::object model;
  try {
    model = take_over(AddressOf(compiled.model()));
  } catch (...) {
    compiled.AdoptModelKeeper(std::make_shared<int>());  // it frees the model when it fails
    throw;
  }
  compiled.AdoptModelKeeper(KeepAlive(model));
  return model;
}

nb::object DataOf(const Scene& scene) {
  nb::object data = ObjectOf(scene.data_keeper());
  if (!data.is_valid()) {
    throw Error("scene '" + scene.name() +
                "' was made in C++ with data of its own, which cannot be shown as mujoco.MjData; "
                "use state() and set_state(), or build it with Scene.build");
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
