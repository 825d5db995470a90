// Samplers of episodes' starts, and subclassing them in Python. C++ threads may call them: each
// call takes the GIL.
#include "sampler.h"

#include <nanobind/nanobind.h>

#include "python_owner.h"
#include "rng.h"
#include "scene_cycles.h"
#include "scene_sharing.h"
#include "signals.h"
#include "task_trampolines.h"
#include "robocell/base/error.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// A task written in Python refers to its class, and that to its script's variables.
int TraverseStart(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  const auto [ready, is_own] = nb::inst_state(self);
  if (!ready) return 0;
  const std::shared_ptr<Task>& task = nb::inst_ptr<EpisodeStart>(self)->task;
  if (task.use_count() == 1) Py_VISIT(TargetOf(task));  // else a copy of this start holds it too
  return is_own ? VisitScene(nb::inst_ptr<EpisodeStart>(self)->scene, visit, arg) : 0;
}
int ClearStart(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<EpisodeStart>(self)->task.reset();
  return 0;
}

PyType_Slot start_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseStart)},
                             {Py_tp_clear, reinterpret_cast<void*>(&ClearStart)},
                             {0, nullptr}};

void BindStart(nb::module_& m) {
  nb::class_<EpisodeStart>(m, "EpisodeStart",
                           "The start of an episode: a scene at its start state, and its task."
                           "\n\nExamples:\n"
                           "    >>> start = rc.tasks.EpisodeStart(scene, rc.tasks.Task())\n"
                           "    >>> start.scene.time()\n"
                           "    0.0",
                           nb::type_slots(start_slots))
      .def(
          "__init__",
          [](EpisodeStart* self, const Scene& scene, nb::object task, const std::string& target,
             const std::vector<std::string>& kinds, const Pose& base_in_world) {
            if (!nb::isinstance<Task>(task)) {
              throw nb::type_error(
                  ("EpisodeStart: task must be a Task, got " + ShortRepr(task)).c_str());
            }
            new (self)
                EpisodeStart{scene, Shared<Task>(std::move(task)), target, kinds, base_in_world};
          },
          "scene"_a, "task"_a, "target_object"_a = "",
          "object_kinds"_a = std::vector<std::string>(), "base_in_world"_a = Pose(),
          nb::sig("def __init__(self, scene: Scene, task: Task, target_object: str = '', "
                  "object_kinds: collections.abc.Sequence[str] = [], base_in_world: Pose = ...) -> "
                  "None"),
          "`target_object`: its name in the scene; `object_kinds`: names in the catalogue, the "
          "target's first.")
      .def_ro("scene", &EpisodeStart::scene, nb::rv_policy::copy,
              "The built scene at its start state.")
      .def_ro("task", &EpisodeStart::task, "The task of the episode.")
      .def_ro("target_object", &EpisodeStart::target_object,
              "Name of the target in the scene; \"\" without one.")
      .def_ro("object_kinds", &EpisodeStart::object_kinds,
              "Names of the objects in the catalogue, the target's first.")
      .def_ro("base_in_world", &EpisodeStart::base_in_world,
              "Pose of the robot's base in the world.")
      .def_rw("redrawn", &EpisodeStart::redrawn,
              "Reason -> count, of places that were tried and rejected.");
}

// A namespace of constants in Python.
struct RefusalReasons {};

void BindRefusal(nb::module_& m) {
  nb::class_<RefusalReasons> reasons(m, "RefusalReason",
                                     "Reasons for refusing a start, of the stages that all tasks "
                                     "share. A task may have reasons of its own.");
  reasons.attr("NO_FREE_PLACE") = Refusal::kNoFreePlace;
  reasons.attr("UNSETTLED") = Refusal::kUnsettled;
  reasons.attr("NO_REACHABLE_BASE_POSE") = Refusal::kNoReachableBasePose;
  reasons.attr("BASE_IN_COLLISION") = Refusal::kBaseInCollision;
  reasons.attr("CAMERA_CONSTRAINT") = Refusal::kCameraConstraint;
  reasons.attr("INVALID_SCENE") = Refusal::kInvalidScene;
  nb::class_<Refusal>(m, "Refusal",
                      "A refused start with its reason."
                      "\n\nExamples:\n"
                      "    >>> rc.tasks.Refusal(\"no_support\", \"no table in the room\")\n"
                      "    <Refusal: no_support, no table in the room>")
      .def(
          "__init__",
          [](Refusal* self, const std::string& reason, const std::string& detail) {
            if (reason.empty()) throw ArgumentError("Refusal: the reason is empty");
            new (self) Refusal{.reason = reason, .detail = detail};
          },
          "reason"_a, "detail"_a = "",
          "`reason`: a few words, one of RefusalReason or of your own, by which refusals are "
          "counted; `detail`: a text for people.")
      .def_ro("reason", &Refusal::reason, "A few words by which refusals are counted.")
      .def_ro("detail", &Refusal::detail, "Human-readable details.")
      .def_ro("stage", &Refusal::stage,
              "Stage that refused: objects, task, base, cameras or settling; '' for a sampler "
              "without stages. Refusals are counted as 'stage: reason'.")
      .def_rw("redrawn", &Refusal::redrawn,
              "Reason -> count, of places that were tried and rejected before.")
      .def("__repr__", [](const Refusal& r) {
        return "<Refusal: " + r.reason + (r.detail.empty() ? "" : ", " + r.detail) + ">";
      });
}

// A source of scenes written in Python refers to its class, and that to its script's variables.
int VisitSource(const TaskSampler& sampler, visitproc visit, void* arg) {
  if (sampler.source().use_count() == 1) Py_VISIT(TargetOf(sampler.source()));
  return 0;
}
int TraverseSampler(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  return nb::inst_ready(self) ? VisitSource(*nb::inst_ptr<TaskSampler>(self), visit, arg) : 0;
}
int ClearSampler(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<TaskSampler>(self)->DropSource();
  return 0;
}

}  // namespace

PyType_Slot sampler_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseSampler)},
                               {Py_tp_clear, reinterpret_cast<void*>(&ClearSampler)},
                               {0, nullptr}};

int VisitSampler(const std::shared_ptr<TaskSampler>& sampler, visitproc visit, void* arg) {
  if (sampler.use_count() != 1) return 0;
  if (PyObject* made_in_python = TargetOf(sampler)) {
    Py_VISIT(made_in_python);  // which visits its source
    return 0;
  }
  return VisitSource(*sampler, visit, arg);
}

SampleResult ToSampleResult(nb::handle self, nb::handle made) {
  ConvertReturned(self, "sample", [&] { RequireInitialised(made); });
  if (nb::isinstance<EpisodeStart>(made))
    return {.start = nb::cast<EpisodeStart>(made), .refusal = {}};
  if (nb::isinstance<Refusal>(made)) return {.start = {}, .refusal = nb::cast<Refusal>(made)};
  ThrowReturned(self, "sample", "an EpisodeStart or a Refusal", made);
}

nb::object SampleForPython(const SampleRequest& request, PythonRng& rng,
                           const std::function<SampleResult(const SampleRequest&, Rng&)>& sample) {
  SampleRequest own_request = request;
  own_request.scene_data = PythonData();
  SignalPoll poll;
  own_request.stop = [&] {
    poll();
    return ShouldStop(request.stop);
  };
  Rng& stream = rng.get();
  SampleResult result;
  {
    const nb::gil_scoped_release unlocked;
    result = sample(own_request, stream);
  }
  if (result.start) return nb::cast(std::move(*result.start));
  return nb::cast(std::move(result.refusal));
}

SamplerFactory MakeSamplerFactory(const SharedKeeper& make_sampler, const SharedKeeper& made) {
  if (!*make_sampler) return {};
  return [factory = make_sampler, made](const RunConfig& run) {
    const nb::gil_scoped_acquire gil;
    nb::object object = CallMaker(ObjectOf(*factory), nb::cast(run));
    if (!nb::isinstance<TaskSampler>(object))
      ThrowReturned("Runner: sampler()", "a TaskSampler", object, PlaceOfCode(ObjectOf(*factory)));
    const std::shared_ptr<TaskSampler> sampler = Shared<TaskSampler>(object);
    *made = KeepAlive(std::move(object));
    return std::shared_ptr<TaskSampler>(made, sampler.get());
  };
}

void BindSampler(nb::module_& m) {
  BindRefusal(m);
  BindStart(m);
  nb::class_<SampleRequest>(m, "SampleRequest",
                            "The requested start. Samplers may use its numbers to spread their "
                            "choices evenly over a run.")
      .def(
          "__init__",
          [](SampleRequest* self, int scene, int episode, int attempt) {
            new (self) SampleRequest{scene, episode, attempt};
          },
          "scene"_a = 0, "episode"_a = 0, "attempt"_a = 0)
      .def_ro("scene", &SampleRequest::scene, "Number of the scene in the source.")
      .def_ro("episode", &SampleRequest::episode, "Number of the episode in that scene.")
      .def_ro("attempt", &SampleRequest::attempt, "Number of the attempt at that episode.")
      .def_prop_ro(
          "stopped", [](const SampleRequest& request) { return ShouldStop(request.stop); },
          "True if the run should end: the sampler may then refuse with any reason.");
  nb::class_<TaskSampler, PySamplerOf<TaskSampler>>(
      m, "TaskSampler",
      "Sets episodes up. Subclasses define sample(request, rng) -> EpisodeStart | Refusal. The "
      "same request and the same numbers from rng must give the same start.",
      nb::type_slots(sampler_slots))
      .def(nb::init<>())
      .def(
          "sample",
          [](TaskSampler& sampler, const SampleRequest& request, PythonRng& rng) {
            return SampleForPython(request, rng,
                                   [&](const SampleRequest& own_request, Rng& stream) {
                                     return sampler.Sample(own_request, stream);
                                   });
          },
          "request"_a, "rng"_a,
          nb::sig("def sample(self, request: SampleRequest, rng: Rng) -> EpisodeStart | Refusal"),
          "Returns a start, or a Refusal with its reason.");
}

}  // namespace robocell::python
