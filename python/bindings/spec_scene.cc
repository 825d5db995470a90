// SceneSpec and its parts except robots.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::python {

void BindSceneSpecs(nb::module_& m) {
  BindSpecClass<SimOptions>(m,
                            "The engine's options for the whole scene, as in MuJoCo's <option>.");
  auto object = BindSpecClass<SceneObject>(
      m, "An object of a scene: a model file, or a primitive with size, rgba, mass and friction.");
  DefYamlFile(object);
  auto scene = BindSpecClass<SceneSpec>(m,
                                        "The contents of a scene and their places. Plain data: "
                                        "Scene.build turns it into a simulation.");
  DefYamlFile(scene);
  scene.def_prop_rw(
      "gravity_z", [](const SceneSpec& s) { return s.gravity[2]; },
      [](SceneSpec& s, double z) { s.gravity[2] = z; }, "Third component of `gravity`, m/s^2.");
}

}  // namespace robocell::python
