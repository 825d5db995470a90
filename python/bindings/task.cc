// Tasks, samplers and experts, and subclassing them in Python. C++ threads may call them: each call
// takes the GIL.
#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include "bindings.h"
#include "rng.h"
#include "robocell/base/error.h"
#include "robocell/task/catalogue.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/task.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace robocell::python {

Rng& PythonRng::get() {
  if (own_) return *own_;
  if (!*lent_) {
    throw Error(
        "this Rng was lent for one call, which is over; keep rng.fork('a purpose') instead");
  }
  return **lent_;
}

namespace {

class PyTask : public Task {
 public:
  NB_TRAMPOLINE(Task);
  void Begin(const Scene& scene) override { NB_OVERRIDE_PURE_NAME("begin", Begin, scene); }
  double Reward(const Scene& scene) override { NB_OVERRIDE_PURE_NAME("reward", Reward, scene); }
  bool Success(const Scene& scene) override { NB_OVERRIDE_PURE_NAME("success", Success, scene); }
  std::string instruction() const override { NB_OVERRIDE_PURE_NAME("instruction", instruction); }
  std::vector<std::string> objects() const override { NB_OVERRIDE_PURE_NAME("objects", objects); }
};

class PyExpert : public Expert {
 public:
  NB_TRAMPOLINE(Expert);
  // The stream is lent, so that what Python draws is drawn from it.
  void Begin(const Scene& scene, Rng& rng) override {
    nb::detail::ticket call(nb_trampoline, "begin", nb::detail::str_hash("begin"), true);
    const RngLoan loan(rng);
    nb_trampoline.base().attr(call.key)(scene, loan.rng());
  }
  Action Act(const Scene& scene, Rng& rng) override {
    nb::detail::ticket call(nb_trampoline, "act", nb::detail::str_hash("act"), true);
    const RngLoan loan(rng);
    return nb::cast<Action>(nb_trampoline.base().attr(call.key)(scene, loan.rng()));
  }
  bool done() const override { NB_OVERRIDE_PURE_NAME("done", done); }
  std::string failure() const override { NB_OVERRIDE_PURE_NAME("failure", failure); }
  int phase() const override { NB_OVERRIDE_PURE_NAME("phase", phase); }
  std::vector<std::string> phase_names() const override {
    NB_OVERRIDE_PURE_NAME("phase_names", phase_names);
  }
};

}  // namespace

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
  nb::class_<Task, PyTask>(m, "Task",
                           "Judges an episode. Subclass it with begin(scene), reward(scene), "
                           "success(scene), instruction(), objects().")
      .def(nb::init<>())
      .def("begin", &Task::Begin, "scene"_a)
      .def("reward", &Task::Reward, "scene"_a)
      .def("success", &Task::Success, "scene"_a)
      .def("instruction", &Task::instruction)
      .def("objects", &Task::objects);
  nb::class_<PickTask, Task>(m, "PickTask",
                             "Lift an object off its support: reward is the height gained (m).")
      .def(nb::init<std::string, std::string, std::vector<std::string>, double>(), "object"_a,
           "kind"_a, "all_objects"_a, "lift_height"_a = 0.01);
  nb::class_<Expert, PyExpert>(m, "Expert",
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
      .def("failure", &Expert::failure)
      .def("phase", &Expert::phase)
      .def("phase_names", &Expert::phase_names);
  m.def("object_kinds", &ObjectKinds, "Kinds of objects that tasks can use.");
}

}  // namespace robocell::python
