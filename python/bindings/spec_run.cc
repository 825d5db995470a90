// RunConfig and its parts.
#include "spec_class.h"
#include "spec_parts.h"

namespace robocell::python {

void BindRunSpecs(nb::module_& m) {
  BindSpecClass<CameraConfig>(m,
                              "One stream of images from a camera."
                              "\n\nExamples:\n"
                              "    >>> run.cameras.streams[0].depth = True");
  BindSpecClass<RenderQuality>(m, "Quality of images; everything costly is off by default.");
  BindSpecClass<RendererConfig>(m, "The back end that renders images, and its quality.");
  auto cameras =
      BindSpecClass<CameraSystemConfig>(m, "The image streams of a run and the size they share.");
  DefYamlFile(cameras);
  BindSpecClass<ObjectPlace>(m, "A start of an object on, inside or next to something else.");
  BindSpecClass<CameraSight>(m, "What a camera has to see of something when an episode begins.");
  BindSpecClass<StartCamera>(m,
                             "A camera that each start of a run places anew."
                             "\n\nExamples:\n"
                             "    >>> run.start.cameras = {\"side\": {\"around\": [\"target\"]}}");
  BindSpecClass<StartConfig>(m,
                             "Places of objects and of the robot's base, and the conditions for "
                             "beginning an episode.");
  BindSpecClass<AugmentConfig>(m, "The source episodes of a run that moves them to new starts.");
  BindSpecClass<ActionNoiseConfig>(
      m, "Bounded noise on the actions of a run, and displaced starts of the arm.");
  BindSpecClass<Rates>(m, "Rates of engine steps, controllers and actions, in ms or in Hz.")
      .def(
          "timestep", [](const Rates& r) { return r.timestep().value(); },
          "The engine's timestep, seconds.")
      .def("policy_period", &Rates::policy_period, "Seconds per action and row.")
      .def(
          "policy_rate",
          [](const Rates& r) {
            const Ratio rate = r.policy_rate();
            return nb::make_tuple(rate.num, rate.den);
          },
          nb::sig("def policy_rate(self) -> tuple[int, int]"),
          "Actions and rows per second, exact: numerator and denominator.");
  auto run = BindSpecClass<RunConfig>(
      m,
      "A run that generates episodes: robot, task, scenes, cameras, rates."
      "\n\nExamples:\n"
      "    >>> run = rc.RunConfig.load(\"examples/demo.yaml\", [\"episodes=2\", \"workers=1\"])\n"
      "    >>> run.episodes\n"
      "    2\n"
      "    >>> run.output = \"experiment_output/small\"\n"
      "    >>> run.task = {\"kind\": \"stack\", \"cubes\": 3}\n"
      "    >>> run.robot = rc.models.robot_file(\"rc7\")\n"
      "    >>> run.start.base_distance = (0.3, 0.5)\n"
      "    >>> run.cameras.resolution = [128, 96]");
  DefYamlFile(run);
  run.def_prop_ro(
      "source_dir", [](const RunConfig& r) { return r.source_dir; },
      "Folder of the run file, to which its paths are relative; '' without one.");
}

}  // namespace robocell::python
