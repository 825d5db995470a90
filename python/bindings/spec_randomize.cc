// RandomizeConfig and its parts.
#include <string>
#include <utility>

#include "randomized.h"
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/randomize_config.h"

namespace robocell::python {
namespace {

void Pin(RandomizeConfig& config, const nb::dict& values) {
  RandomizedValues pinned = config.pinned;
  for (const auto& [key, value] : values) {
    const FieldPath path("values");
    const std::string name = ToKey(key, path);
    pinned[name] = *ToSpecBox<RandomizedValue>(value, FieldPath(path, name));
  }
  config.pinned = std::move(pinned);
}

}  // namespace

nb::dict RandomizedDict(const RandomizedValues& values) {
  nb::dict out;
  for (const auto& [name, value] : values.entries()) {
    if (!value->word.empty())
      out[name.c_str()] = value->word;
    else if (value->numbers.size() == 1)
      out[name.c_str()] = value->numbers.front();
    else
      out[name.c_str()] = nb::cast(value->numbers);
  }
  return out;
}

void BindRandomizeSpecs(nb::module_& m) {
  BindSpecClass<RandomNumber>(m,
                              "A number, or the distribution that it is drawn from."
                              "\n\nExamples:\n"
                              "    >>> rc.tasks.RandomNumber(uniform=[0.2, 0.6])\n"
                              "    RandomNumber(uniform=[0.2, 0.6])");
  BindSpecClass<RandomProperty>(
      m, "A random property of an element: absolute, or a factor of its own value.");
  BindSpecClass<RandomLights>(m, "Random lights: number, direction, brightness, colour.");
  BindSpecClass<RandomLook>(m, "The random look of objects, robots, bodies or geoms.");
  BindSpecClass<RandomDynamics>(m, "The random physics of objects, robots or bodies.");
  BindSpecClass<RandomClutter>(m, "Random objects that the task does not need.");
  BindSpecClass<RandomizedValue>(m, "A value of an episode: numbers, or the name of a texture.");
  auto randomize = BindSpecClass<RandomizeConfig>(
      m,
      "What varies between episodes beside the starts of the task: lights, looks, physics."
      "\n\nExamples:\n"
      "    >>> cell = rc.EnvConfig.load(rc.models.cell_file(\"rc7\"))\n"
      "    >>> cell.randomize = rc.tasks.RandomizeConfig(\n"
      "    ...     dynamics={\"robots\": {\"damping\": {\"scale\": {\"uniform\": [0.8, 1.2]}}}})\n"
      "    >>> env = rc.Env(cell)\n"
      "    >>> observation, info = env.reset(seed=1)\n"
      "    >>> list(env.randomized)\n"
      "    ['robot/damping_scale']");
  randomize
      .def("pin", &Pin, nb::arg("values"),
           nb::sig("def pin(self, values: dict[str, float | list[float] | str]) -> None"),
           "Fixes values by their names, such as those of an episode: "
           "`run.randomize.pin(episode.randomized)`.")
      .def(
          "describe", [](const RandomizeConfig& config) { return Describe(config); },
          "Returns one line for each thing that varies.");
}

}  // namespace robocell::python
