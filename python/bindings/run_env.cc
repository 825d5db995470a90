// The cell of a run as an environment (rollout/run_env.h), under Python's robocell.envs.
#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <optional>

#include "bindings.h"
#include "features.h"
#include "in_use.h"
#include "python_owner.h"
#include "randomized.h"
#include "sampler.h"
#include "scene_sharing.h"
#include "signals.h"
#include "task_trampolines.h"
#include "robocell/rollout/run_env.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

std::string PlaceOfRunEnv(const RunEnv& env) { return "run '" + env.run().run + "'"; }

nb::tuple Step(RunEnv& env, const nb::dict& values) {
  const std::map<std::string, std::vector<double>> actions = ToNumbersByName(values);
  const InUse use(env, &PlaceOfRunEnv, "stepped");
  RunStep step;
  {
    const nb::gil_scoped_release release;
    step = env.Act(actions);
  }
  nb::dict info;
  info["is_success"] = step.success;
  info["progress"] = step.progress;
  info["subtask"] = step.subtask;
  info["ik_failed"] = step.ik_failed;
  info["reason"] = step.reason;
  return nb::make_tuple(step.reward, step.terminated, step.truncated, info);
}

// The same as for an Env (env.cc): a task or a sampler written in Python refers to its script's
// variables, and the environment is often among them.
int Traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  const RunEnv& env = *nb::inst_ptr<RunEnv>(self);
  if (UseByOthers(&env)) return 0;  // its members change without the GIL; its user holds it
  if (env.task().use_count() == 1) Py_VISIT(TargetOf(env.task()));
  return VisitSampler(env.sampler(), visit, arg);
}

int Clear(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<RunEnv>(self)->Drop();
  return 0;
}

PyType_Slot run_env_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&Traverse)},
                               {Py_tp_clear, reinterpret_cast<void*>(&Clear)},
                               {0, nullptr}};

}  // namespace

void BindRunEnv(nb::module_& m) {
  nb::class_<RunEnv>(m, "RunEnv",
                     "The cell of a run as an environment: it returns what an episode of the run "
                     "records, and takes the actions that it records. One thread at a time.",
                     nb::type_slots(run_env_slots))
      .def(
          "__init__",
          [](RunEnv* self, const RunConfig& run) {
            ImportMujoco();  // before the work starts
            new (self) RunEnv(run, PythonData());
          },
          "run"_a)
      .def_prop_ro(
          "run", [](const RunEnv& env) { return env.run(); }, "A copy of the run's configuration.")
      .def(
          "reset",
          [](RunEnv& env, int index, int attempt) {
            const InUse use(env, &PlaceOfRunEnv, "reset");
            SignalPoll poll;
            const nb::gil_scoped_release release;
            env.Reset(index, attempt, [&] {
              poll();
              return false;
            });
          },
          "index"_a, "attempt"_a = 0,
          "Resets to start `index` of the run's plan: its first attempt from `attempt` on that is "
          "accepted. Raises Error with the reasons if there is none.")
      .def(
          "row",
          [](RunEnv& env) {
            const InUse use(env, &PlaceOfRunEnv, "read");
            std::optional<CellRow> row;
            {
              const nb::gil_scoped_release release;
              row.emplace(env.Row());
            }
            return RowArrays(*row);
          },
          nb::sig("def row(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
          "Returns the row that would be recorded now: {name: numbers or image}.")
      .def("act", &Step, "actions"_a,
           nb::sig("def act(self, actions: dict[str, numpy.typing.ArrayLike]) -> tuple[float, "
                   "bool, bool, dict[str, typing.Any]]"),
           "Makes one step with actions by their names in the dataset. Returns (reward, "
           "terminated, truncated, info).")
      .def_prop_ro(
          "observed", [](const RunEnv& env) { return FeatureList(env.observed()); },
          nb::sig("def observed(self) -> list[Feature]"),
          "Features that are observed, by their names in the dataset.")
      .def_prop_ro(
          "commanded", [](const RunEnv& env) { return FeatureList(env.commanded()); },
          nb::sig("def commanded(self) -> list[Feature]"),
          "Features of the actions, by their names in the dataset.")
      .def_prop_ro("instruction", &RunEnv::instruction,
                   "The instruction of this episode, in words.")
      .def_prop_ro(
          "object_kinds", [](const RunEnv& env) { return env.start().object_kinds; },
          "Kinds of the objects of this episode, the target's first.")
      .def_prop_ro(
          "randomized", [](const RunEnv& env) { return RandomizedDict(env.start().randomized); },
          nb::sig("def randomized(self, /) -> dict[str, float | list[float] | str]"),
          "The values that `randomize` drew for this episode, by their names.")
      .def_prop_ro(
          "scene", [](const RunEnv& env) { return Scene(env.start().scene); },
          "The scene of this episode.");
}

}  // namespace robocell::python
