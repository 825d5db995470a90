// SceneSpec and its parts except robots.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::python {

void BindSceneSpecs(nb::module_& m) {
  BindSpecClass<SimOptions>(m,
                            "The engine's options for the whole scene, as in MuJoCo's <option>.");
  auto object = BindSpecClass<SceneObject>(
      m,
      "An object of a scene: a model file, or a primitive with size, rgba, mass and friction."
      "\n\nExamples:\n"
      "    >>> mug = rc.SceneObject(name=\"mug\", mjcf_path=\"mug\", pos=[0.4, 0.2, 0])\n"
      "    >>> scene.add_object(mug)");
  DefYamlFile(object);
  auto scene = BindSpecClass<SceneSpec>(
      m,
      "The contents of a scene and their places. Plain data: "
      "Scene.build turns it into a simulation."
      "\n\nExamples:\n"
      "    >>> table = rc.SceneSpec(base=\"tabletop\", timestep=0.002)\n"
      "    >>> table.robots.append(rc.RobotSpec(name=\"arm\", config=config))\n"
      "    >>> table.objects.append(rc.SceneObject(name=\"mug\", mjcf_path=\"mug\", pos=[0.1, 0, "
      "0.5]))\n"
      "    >>> [each.name for each in table.objects]\n"
      "    ['mug']");
  DefYamlFile(scene);
  scene.def_prop_rw(
      "gravity_z", [](const SceneSpec& s) { return s.gravity[2]; },
      [](SceneSpec& s, double z) { s.gravity[2] = z; }, "Third component of `gravity`, m/s^2.");
}

}  // namespace robocell::python
