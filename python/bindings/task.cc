// Tasks and experts, and subclassing them in Python. C++ threads may call them: each call takes the
// GIL. Those of the pick task are in pick.cc.
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "rng.h"
#include "task_trampolines.h"
#include "robocell/base/error.h"
#include "robocell/scenes/catalogue.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

Rng& PythonRng::get() {
  if (own_) return *own_;
  if (!*lent_) {
    throw Error(
        "this Rng was lent for one call, which is over; keep rng.fork('a purpose') instead");
  }
  return **lent_;
}

void BindTask(nb::module_& m) {
  nb::class_<PythonRng>(
      m, "Rng",
      "A keyed random stream: the same keys give the same numbers, on every machine.\n\nOne that "
      "is handed to a function of yours is lent for that call; to keep one, fork it.")
      .def_static(
          "stream",
          [](uint64_t seed, const std::string& purpose) {
            return PythonRng(Rng::Stream(seed, purpose));
          },
          "seed"_a, "purpose"_a)
      .def(
          "uniform",
          [](PythonRng& r, double lower, double upper) { return r.get().Uniform(lower, upper); },
          "lower"_a = 0.0, "upper"_a = 1.0)
      .def(
          "integer", [](PythonRng& r, uint64_t count) { return r.get().UniformInt(count); },
          "count"_a, "One of 0 ... count - 1.")
      .def("normal", [](PythonRng& r) { return r.get().Normal(); })
      .def(
          "fork",
          [](PythonRng& r, const std::string& purpose) { return PythonRng(r.get().Fork(purpose)); },
          "purpose"_a, "A stream of its own, which may be kept.");
  nb::class_<Task, PyTaskOf<Task>>(
      m, "Task",
      "Judges an episode. Subclass it with begin(scene), reward(scene), "
      "success(scene), instruction(), objects().")
      .def(nb::init<>())
      .def("begin", &Task::Begin, "scene"_a)
      .def("reward", &Task::Reward, "scene"_a)
      .def("success", &Task::Success, "scene"_a)
      .def("instruction", &Task::instruction)
      .def("objects", &Task::objects);
  nb::class_<Expert, PyExpertOf<Expert>>(
      m, "Expert",
      "Acts from the simulation's state. Subclass it with begin(scene, "
      "rng), act(scene, rng) -> {robot: {group: GroupCommand}},\n"
      "done(), failure(), phase(), phase_names().")
      .def(nb::init<>())
      .def(
          "begin", [](Expert& e, const Scene& s, PythonRng& rng) { e.Begin(s, rng.get()); },
          "scene"_a, "rng"_a)
      .def(
          "act", [](Expert& e, const Scene& s, PythonRng& rng) { return e.Act(s, rng.get()); },
          "scene"_a, "rng"_a, "{robot: {group: GroupCommand}} until the next policy tick.")
      .def("done", &Expert::done)
      .def("failure", &Expert::failure,
           "Why it gave up, \"\" otherwise. A rollout that ends with one is no success, whatever "
           "its "
           "task says.")
      .def("phase", &Expert::phase)
      .def("phase_names", &Expert::phase_names);
  m.def("object_kinds", &ObjectKinds, "Kinds of objects that tasks can use.");
}

}  // namespace robocell::python
