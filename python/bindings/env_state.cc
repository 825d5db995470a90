// States of environments as values, and records of episodes.
#include "robocell/env/env_state.h"

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "env.h"
#include "in_use.h"
#include "signals.h"
#include "spec_enums.h"
#include "values.h"
#include "robocell/base/names.h"
#include "robocell/env/env.h"
#include "robocell/env/env_record.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

StateFrame ToStateFrame(const std::string& text) {
  for (const auto& [frame, name] : EnumNames<StateFrame>::kNames) {
    if (text == name) return frame;
  }
  ThrowValue(FieldPath("frame"),
             "must be one of " + ListNames(ValueNames<StateFrame>()) + ", got '" + text + "'");
}

nb::object Rows(const std::vector<double>& numbers, size_t rows) {
  return NumberCopy(numbers, {rows, rows == 0 ? 0 : numbers.size() / rows});
}

// Of arrays as the attributes give them.
void InitRecord(EnvRecord* self, const EnvState& start, nb::handle actions, nb::handle observations,
                nb::handle rewards) {
  new (self) EnvRecord{.start = start,
                       .actions = ToDoubles(actions, "actions"),
                       .observations = ToDoubles(observations, "observations"),
                       .rewards = ToRow(rewards, "rewards")};
}

void BindState(nb::module_& m) {
  nb::class_<EnvState>(
      m, "EnvState",
      "All that an environment needs to go on as it did; for others of the same configuration. It "
      "can be pickled, and is made of numbers: EnvState(state.numbers) is the same.")
      .def(
          "__init__",
          [](EnvState* self, nb::handle numbers) {
            new (self) EnvState(EnvState::FromNumbers(ToRow(numbers, "numbers")));
          },
          "numbers"_a, nb::sig("def __init__(self, numbers: numpy.typing.ArrayLike) -> None"))
      .def_prop_ro(
          "numbers", [](const EnvState& s) { return NumberCopy(s.numbers()); },
          nb::sig("def numbers(self, /) -> numpy.typing.NDArray[numpy.float64]"), "For files.")
      .def_prop_ro(
          "root_frame_to_world", [](const EnvState& s) { return s.root_frame_to_world; },
          "Where the rig stood.")
      .def("__getstate__", [](const EnvState& s) { return s.numbers(); })
      .def("__setstate__", [](EnvState& s, const std::vector<double>& numbers) {
        new (&s) EnvState(EnvState::FromNumbers(numbers));
      });
}

void BindRecord(nb::module_& m) {
  nb::class_<EnvRecord>(m, "EnvRecord",
                        "An episode as it was acted and observed: n steps. Its arrays make it "
                        "again; it can be pickled, and `save` keeps it in a file.")
      .def("__init__", &InitRecord, "start"_a, "actions"_a, "observations"_a, "rewards"_a,
           nb::sig("def __init__(self, start: EnvState, actions: numpy.typing.ArrayLike, "
                   "observations: numpy.typing.ArrayLike, rewards: numpy.typing.ArrayLike) -> "
                   "None"))
      .def(
          "save", [](const EnvRecord& r, const std::filesystem::path& file) { r.Save(file); },
          "file"_a,
          "Writes a file that EnvRecord.load reads, in C++ too: a .npy with one row of float64.")
      .def_static(
          "load", [](const std::filesystem::path& file) { return EnvRecord::Load(file); }, "file"_a,
          "Of a file that save wrote. IoError for one that is no record.")
      .def("__getstate__",
           [](const EnvRecord& r) {
             return std::vector{r.start.numbers(), r.actions, r.observations, r.rewards};
           })
      .def("__setstate__",
           [](EnvRecord& r, const std::vector<std::vector<double>>& lists) {
             if (lists.size() != 4) throw ArgumentError("this is no record of an environment");
             new (&r) EnvRecord{EnvState::FromNumbers(lists[0]), lists[1], lists[2], lists[3]};
           })
      .def_prop_ro("steps", &EnvRecord::steps)
      .def_prop_ro(
          "start", [](const EnvRecord& r) { return EnvState(r.start); }, "The state at its start.")
      .def_prop_ro(
          "actions", [](const EnvRecord& r) { return Rows(r.actions, r.rewards.size()); },
          nb::sig("def actions(self, /) -> numpy.typing.NDArray[numpy.float64]"), "(n, a).")
      .def_prop_ro(
          "observations",
          [](const EnvRecord& r) { return Rows(r.observations, r.rewards.size() + 1); },
          nb::sig("def observations(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "(n + 1, m): at the start, and after each step.")
      .def_prop_ro(
          "rewards", [](const EnvRecord& r) { return NumberCopy(r.rewards); },
          nb::sig("def rewards(self, /) -> numpy.typing.NDArray[numpy.float64]"), "(n,).");
  nb::class_<EnvReplay>(m, "EnvReplay", "What became of the replay of a record.")
      .def_ro("steps", &EnvReplay::steps, "Replayed, the one that differs included.")
      .def_ro("difference", &EnvReplay::difference,
              "The first, as 'after step 3: robot.joints[2] is 0.31, recorded 0.3'; '' without.")
      .def_prop_ro("same", &EnvReplay::same);
}

}  // namespace

void BindEnvState(nb::module_& m) {
  BindState(m);
  BindRecord(m);
}

void DefEnvState(nb::class_<Env>& env) {
  env.def("get_state", &Env::state, "The present state as a value.")
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
          "Goes on from a state of an environment of the same configuration; the observation of "
          "then.\n\nWhat follows is the same to the bit; with frame 'root' what can move of "
          "root_frame_objects is put where it was in the root frame, for a rig that stands "
          "elsewhere.")
      .def("start_record", &Env::StartRecord,
           "Notes actions and observations from now on; a reset drops them.\n\n"
           "Error when it does so already.")
      .def("stop_record", &Env::StopRecord, "The record since start_record.")
      .def(
          "replay",
          [](Env& e, const EnvRecord& record, const std::string& frame, double tolerance) {
            const StateFrame in = ToStateFrame(frame);
            const InUse use(e, &Place, "replayed");
            const nb::gil_scoped_release release;
            return ReplayRecord(e, record, in, tolerance, SparsePoll());
          },
          "record"_a, "frame"_a = "world", "tolerance"_a = 0.0,
          "Does what was recorded again, from its start, until a number differs by more than "
          "`tolerance` (0: to the bit); frame as of set_state. Ctrl-C ends it.");
}

}  // namespace robocell::python
