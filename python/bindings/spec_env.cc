// EnvConfig and what it holds.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/env_config.h"

namespace robocell::python {

void BindEnvSpecs(nb::module_& m) {
  BindSpecClass<EnvObject>(
      m,
      "A model or a primitive in one of an environment's frames; a model also written as a pair "
      "(file, Pose).");
  BindSpecClass<ObjectVariation>(m, "How an object differs from episode to episode.");
  BindSpecClass<CameraAdderConfig>(
      m, "Where a camera is added: in the root frame, or at a robot's attachment site.");
  BindSpecClass<SimSettings>(m, "How an environment's simulation runs.");
  BindSpecClass<WrapperConfig>(m, "What is around the robots' actions and observations.");
  auto env = BindSpecClass<EnvConfig>(
      m, "A cell of one or several robots as an environment: robots, frames, objects, cameras.");
  DefYamlFile(env);
}

}  // namespace robocell::python
