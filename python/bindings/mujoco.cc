// Known defects of the loaded engine.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.h"
#include "robocell/mujoco/engine_defects.h"

namespace nb = nanobind;

namespace robocell::python {

void BindMujoco(nb::module_& m) {
  nb::class_<EngineDefect>(m, "EngineDefect", "A known defect of the loaded MuJoCo.")
      .def_ro("name", &EngineDefect::name, "Short name, used in the metadata of episodes.")
      .def_ro("what", &EngineDefect::what, "The wrong behaviour and its conditions.")
      .def_ro("guard", &EngineDefect::guard, "robocell's workaround; empty if there is none.")
      .def_ro("fixed_in", &EngineDefect::fixed_in, "The version of MuJoCo without the defect.")
      .def("__repr__", [](const EngineDefect& defect) {
        return fmt::format("EngineDefect(name='{}', fixed_in='{}')", defect.name, defect.fixed_in);
      });
  m.def("known_engine_defects", &KnownEngineDefects,
        "Returns the known defects of the loaded MuJoCo; `robocell doctor` prints them.");
}

}  // namespace robocell::python
