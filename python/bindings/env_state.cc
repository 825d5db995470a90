// States of environments as values.
#include "robocell/env/env_state.h"

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "env.h"
#include "in_use.h"
#include "signals.h"
#include "spec_enums.h"
#include "values.h"
#include "robocell/base/suggestions.h"
#include "robocell/env/env.h"

namespace robocell::python {

using namespace nb::literals;

StateFrame ToStateFrame(const std::string& text) {
  for (const auto& [frame, name] : EnumNames<StateFrame>::kNames) {
    if (text == name) return frame;
  }
  ThrowValue(FieldPath("frame"),
             "must be one of " + ListNames(ValueNames<StateFrame>()) + ", got '" + text + "'");
}

namespace {

void BindState(nb::module_& m) {
  nb::class_<EnvState>(
      m, "EnvState",
      "The complete state of an environment, also for others of the same configuration. It can be "
      "pickled, and consists of numbers: EnvState(state.numbers) is the same.")
      .def(
          "__init__",
          [](EnvState* self, nb::handle numbers) {
            new (self) EnvState(EnvState::FromNumbers(ToRow(numbers, "numbers")));
          },
          "numbers"_a, nb::sig("def __init__(self, numbers: numpy.typing.ArrayLike) -> None"))
      .def_prop_ro(
          "numbers", [](const EnvState& s) { return NumberCopy(s.numbers()); },
          nb::sig("def numbers(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "The state as numbers (n,), for files.")
      .def_prop_ro(
          "root_frame_to_world", [](const EnvState& s) { return s.root_frame_to_world; },
          "Pose of the root frame in the world.")
      .def("__getstate__", [](const EnvState& s) { return s.numbers(); })
      .def("__setstate__", [](EnvState& s, const std::vector<double>& numbers) {
        new (&s) EnvState(EnvState::FromNumbers(numbers));
      });
}

}  // namespace

void BindEnvState(nb::module_& m) { BindState(m); }

void DefEnvState(nb::class_<Env>& env) {
  env.def("get_state", &Env::state,
          "Returns the present state as a value."
          "\n\nExamples:\n"
          "    >>> observation, info = env.reset(seed=0)\n"
          "    >>> state = env.get_state()\n"
          "    >>> observation = env.set_state(state)")
      .def(
          "set_state",
          [](Env& e, const EnvState& state, const std::string& frame) {
            const StateFrame in = ToStateFrame(frame);
            const InUse use(e, &Place, "restored");
            {
              const nb::gil_scoped_release release;
              e.SetState(state, in);
            }
            return Observation(e);
          },
          "state"_a, "frame"_a = "world",
          nb::sig("def set_state(self, state: EnvState, frame: str = 'world') -> dict[str, "
                  "typing.Any]"),
          "Continues from a state of an environment of the same configuration, and returns its "
          "observation.\n\nAll later steps are reproduced exactly. With frame 'root', movable "
          "root_frame_objects keep their pose in the root frame, for a rig at another pose in the "
          "world.");
}

}  // namespace robocell::python
