// EnvConfig and its parts.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/env_config.h"

namespace robocell::python {

void BindEnvSpecs(nb::module_& m) {
  BindSpecClass<EnvObject>(
      m,
      "A model or a primitive in one of an environment's frames; a model also written as a pair "
      "(file, Pose).");
  BindSpecClass<ObjectVariation>(m, "Random variation of an object in each episode.");
  BindSpecClass<CameraAdderConfig>(
      m,
      "A camera to add, in the root frame or at a robot's attachment site."
      "\n\nExamples:\n"
      "    >>> cell = rc.EnvConfig.load(rc.models.cell_file(\"rc7\"))\n"
      "    >>> above = rc.Pose(translation=[0.5, 0, 1.2], rpy=[np.pi, 0, 0])\n"
      "    >>> cell.camera_adds[\"above\"] = rc.envs.CameraAdderConfig(fovy=50, offset=above)");
  BindSpecClass<SimSettings>(m, "Settings of an environment's simulation.");
  BindSpecClass<WrapperConfig>(m, "Wrappers of the robots' actions and observations.");
  auto env = BindSpecClass<EnvConfig>(
      m,
      "A cell of one or several robots as an environment: robots, frames, objects, cameras."
      "\n\nExamples:\n"
      "    >>> cell = rc.EnvConfig.load(rc.models.cell_file(\"rc7\"))\n"
      "    >>> cell.control_mode = \"cartesian_tquat\"\n"
      "    >>> env = rc.Env(cell)");
  DefYamlFile(env);
}

}  // namespace robocell::python
