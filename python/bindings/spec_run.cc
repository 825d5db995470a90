// RunConfig and what it holds.
#include "spec_class.h"
#include "spec_parts.h"

namespace robocell::python {

void BindRunSpecs(nb::module_& m) {
  BindSpecClass<CameraConfig>(m, "One stream of images from a camera.");
  BindSpecClass<RenderQuality>(m, "How images are drawn; everything costly is off by default.");
  auto cameras =
      BindSpecClass<CameraSystemConfig>(m, "The image streams of a run and the size they share.");
  DefYamlFile(cameras);
  BindSpecClass<TaskConfig>(m, "What the robot does.");
  BindSpecClass<SceneSource>(m, "Where a run's scenes come from.");
  BindSpecClass<Rates>(m, "Times of engine, control and policy, ms.");
  auto run = BindSpecClass<RunConfig>(m, "What to generate: robot, task, scenes, cameras, rates.");
  DefYamlFile(run);
}

}  // namespace robocell::python
