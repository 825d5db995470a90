// The pick task: its judge, sampler and expert. All can be subclassed in Python, the sampler stage
// by stage.
#include <nanobind/nanobind.h>

#include <algorithm>
#include <utility>

#include "bindings.h"
#include "python_owner.h"
#include "rng.h"
#include "task_trampolines.h"
#include "robocell/base/hook_error.h"
#include "robocell/expert/pick_and_place_planner.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/task/pick_sampler.h"
#include "robocell/task/pick_task.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

// Returns a list of copies, which Python may keep.
nb::list ToList(const std::vector<SceneObject>& objects) {
  nb::list list;
  for (const SceneObject& object : objects) list.append(nb::cast(object));
  return list;
}

std::vector<SceneObject> FromList(const nb::list& list) {
  std::vector<SceneObject> objects;
  for (const nb::handle item : list) {
    if (!nb::isinstance<SceneObject>(item)) {
      throw nb::type_error(
          ("place_objects(): `objects` must be SceneObjects, got " + ShortRepr(item)).c_str());
    }
    objects.push_back(nb::cast<const SceneObject&>(item));
  }
  return objects;
}

class PyPickTaskSampler : public PySamplerOf<PickTaskSampler> {
 public:
  using PySamplerOf<PickTaskSampler>::PySamplerOf;

  SceneSpec MakeBaseScene(int scene_index) override {
    return CallMethod<SceneSpec>(
        nb_trampoline, "make_base_scene", own(),
        [&](auto* s) { return s->PickTaskSampler::MakeBaseScene(scene_index); }, scene_index);
  }
  std::vector<std::string> ChooseKinds(const SampleRequest& request, Rng& rng) override {
    const RequestLoan asked(request);
    return CallWithRng<std::vector<std::string>>(
        nb_trampoline, "choose_kinds", own(),
        [&](auto* s) { return s->PickTaskSampler::ChooseKinds(request, rng); }, rng,
        asked.request());
  }
  bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng) override {
    const nb::detail::ticket call(nb_trampoline, "place_objects",
                                  nb::detail::str_hash("place_objects"), false);
    if (!call.key.is_valid()) return PickTaskSampler::PlaceObjects(support, objects, rng);
    const RngLoan loan(rng);
    const nb::list list = ToList(objects);
    const nb::handle self = nb_trampoline.base();
    const bool placed =
        Returned<bool>(self, "place_objects", self.attr(call.key)(support, list, loan.rng()));
    std::vector<SceneObject> moved =
        ConvertReturned(self, "place_objects", [&] { return FromList(list); });
    const auto same_name = [](const SceneObject& a, const SceneObject& b) {
      return a.name == b.name;
    };
    if (!std::equal(moved.begin(), moved.end(), objects.begin(), objects.end(), same_name)) {
      throw HookError(
          "PickTaskSampler: place_objects() must not change which objects there are nor their "
          "order, only their poses",
          PlaceOfMethod(self, "place_objects"));
    }
    objects = std::move(moved);
    return placed;
  }
  BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng) override {
    const RequestLoan asked(request);
    return CallWithRng<BasePlacement>(
        nb_trampoline, "choose_base_placement", own(),
        [&](auto* s) { return s->PickTaskSampler::ChooseBasePlacement(request, rng); }, rng,
        asked.request());
  }
  std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                      const Pose& target, const BasePlacement& placement,
                                      Rng& rng) override {
    return CallWithRng<std::optional<Pose>>(
        nb_trampoline, "propose_base_pose", own(),
        [&](auto* s) {
          return s->PickTaskSampler::ProposeBasePose(robot, support, target, placement, rng);
        },
        rng, robot, support, target, placement);
  }
  std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                          const std::string& target_body) override {
    return CallMethod<std::optional<Refusal>>(
        nb_trampoline, "validate_base_pose", own(),
        [&](auto* s) { return s->PickTaskSampler::ValidateBasePose(scene, robot, target_body); },
        scene, robot, target_body);
  }
  std::optional<Refusal> ValidateCameras(Scene& scene, const std::string& target_body) override {
    return CallMethod<std::optional<Refusal>>(
        nb_trampoline, "validate_cameras", own(),
        [&](auto* s) { return s->PickTaskSampler::ValidateCameras(scene, target_body); }, scene,
        target_body);
  }
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override {
    const nb::detail::ticket call(nb_trampoline, "make_task", nb::detail::str_hash("make_task"),
                                  false);
    if (!call.key.is_valid()) return PickTaskSampler::MakeTask(target, kind, objects);
    nb::object made = nb_trampoline.base().attr(call.key)(target, kind, objects);
    if (!nb::isinstance<Task>(made))
      ThrowReturned(nb_trampoline.base(), "make_task", "a Task", made);
    return ConvertReturned(made, "__init__", [&] { return Shared<Task>(made); });
  }

 private:
  PickTaskSampler* own() { return this; }
};

void BindPickTask(nb::module_& m) {
  nb::class_<PickTask, Task, PyTaskOf<PickTask>>(
      m, "PickTask",
      "A task to pick up an object. Success: it is lift_height (m) above its start while robots "
      "hold it:\nnothing else touches it, and a gripper has it between its fingers, or several "
      "robots have\nit between them. The reward, 0 to 1, is half for a TCP near the object and "
      "half for its\nheight; at success it is 1.")
      .def(nb::init<std::string, std::string, std::vector<std::string>, double>(), "object"_a,
           "kind"_a, "all_objects"_a, "lift_height"_a = kLiftHeight)
      .def(
          "bind",
          [](PickTask& t, const Scene& scene, const TaskSetting& setting) {
            t.PickTask::Bind(scene, setting);
          },
          "scene"_a, "setting"_a, "Looks up the objects and the robots in the compiled scene.")
      .def(
          "begin", [](PickTask& t, const Scene& scene) { t.PickTask::Begin(scene); }, "scene"_a,
          Unlocked(), "Binds a task that is not bound yet, with all robots of the scene.")
      .def(
          "judge", [](PickTask& t, const Scene& scene) { return t.PickTask::Judge(scene); },
          "scene"_a, Unlocked(), "Returns the TaskVerdict of the present state.")
      .def(
          "reward", [](PickTask& t, const Scene& scene) { return t.PickTask::Judge(scene).reward; },
          "scene"_a, Unlocked(), "Returns the reward of the present state, 0 to 1.")
      .def(
          "success",
          [](PickTask& t, const Scene& scene) { return t.PickTask::Judge(scene).success; },
          "scene"_a, Unlocked(), "Returns True if the object is lifted in the present state.")
      .def(
          "instruction", [](const PickTask& t) { return t.PickTask::instruction(); },
          "Returns the instruction in words: \"pick up the mug\".")
      .def(
          "objects", [](const PickTask& t) { return t.PickTask::objects(); },
          "Returns the names of the objects, the target first.")
      .def(
          "resting_objects", [](const PickTask& t) { return t.PickTask::resting_objects(); },
          "Returns the names of the objects that must lie still when an episode begins.")
      .def(
          "starts",
          [](PickTask& t, PythonRng& rng) {
            nb::dict poses;
            for (const auto& [body, pose] : t.PickTask::Starts(rng.get()))
              poses[body.c_str()] = pose;
            return poses;
          },
          "rng"_a, nb::sig("def starts(self, rng: Rng) -> collections.abc.Mapping[str, Pose]"),
          "Returns starts of the objects: {name in the scene: pose in the world}.")
      .def(
          "memory", [](const PickTask& t) { return MemoryArray(t.PickTask::memory()); },
          nb::sig("def memory(self) -> numpy.typing.ArrayLike"),
          "Returns the task's memory of the episode, for saved states.")
      .def(
          "recall",
          [](PickTask& t, nb::handle memory) {
            const Numbers numbers(memory, FieldPath("memory"));
            t.PickTask::Recall(numbers.span());
          },
          "memory"_a,
          nb::sig("def recall(self, memory: numpy.typing.NDArray[numpy.float64]) -> None"),
          "Restores the result of memory().");
}

// The common part of all scripted planners.
template <class Planner>
auto BindPlanner(nb::module_& m, const char* name, const char* doc) {
  return nb::class_<Planner, Expert, PyExpertOf<Planner>>(m, name, doc)
      .def(nb::init<const RunConfig&, const EpisodeStart&>(), "run"_a, "start"_a)
      .def(
          "begin",
          [](Planner& e, const Scene& s, PythonRng& rng) {
            const nb::gil_scoped_release release;
            e.Planner::Begin(s, rng.get());
          },
          "scene"_a, "rng"_a, "Plans from the start state of an episode.")
      .def(
          "act",
          [](Planner& e, const Scene& s, PythonRng& rng) {
            const nb::gil_scoped_release release;
            return e.Planner::Act(s, rng.get());
          },
          "scene"_a, "rng"_a, "Returns {robot: {group: GroupCommand}} until the next policy tick.")
      .def(
          "done", [](const Planner& e) { return e.Planner::done(); },
          "Returns True when the plan is carried out or given up.")
      .def(
          "failure", [](const Planner& e) { return e.Planner::failure(); },
          "Returns why the expert gave up, \"\" otherwise.")
      .def(
          "phase", [](const Planner& e) { return e.Planner::phase(); },
          "Returns the index of the present phase in phase_names().")
      .def(
          "phase_names", [](const Planner& e) { return e.Planner::phase_names(); },
          "Returns the names of the phases, which episodes record as labels.");
}

void BindPlanners(nb::module_& m) {
  BindPlanner<PickPlanner>(
      m, "PickPlanner",
      "The scripted expert: picks up the start's target from above, with any robot that has one "
      "arm and one gripper that can be measured.")
      .def_prop_ro("attempts", &PickPlanner::attempts, "Number of grasps tried so far.");
  BindPlanner<PickAndPlacePlanner>(
      m, "PickAndPlacePlanner",
      "The scripted expert of pick_and_place tasks, for any robot with one arm and one gripper. It "
      "picks the\nobject up as PickPlanner does, plans how to put it down once it is in the hand, "
      "and picks up\nagain what slipped. It needs a task of kind pick_and_place.");
}

void BindPlaces(nb::module_& m) {
  nb::class_<Support>(m, "Support", "A level rectangle that objects are put on.")
      .def(
          "__init__",
          [](Support* self, const Pose& frame, double half_x, double half_y, double thickness) {
            new (self) Support{frame, half_x, half_y, thickness};
          },
          "frame_to_world"_a, "half_x"_a, "half_y"_a, "thickness"_a = 0.0)
      .def_ro("frame_to_world", &Support::frame_to_world, "Pose of its middle, z up.")
      .def_ro("half_x", &Support::half_x, "Half extent along its x axis, metres.")
      .def_ro("half_y", &Support::half_y, "Half extent along its y axis, metres.")
      .def_ro("thickness", &Support::thickness, "Depth of its body below the face, metres.");
  nb::class_<BasePlacement>(m, "BasePlacement", "Place of a robot's base relative to the target.")
      .def(
          "__init__",
          [](BasePlacement* self, double distance, double height) {
            const BasePlacement placement{distance, height};
            RequireFinite(placement);
            new (self) BasePlacement(placement);
          },
          "distance"_a, "height"_a)
      .def_ro("distance", &BasePlacement::distance, "Horizontal distance, metres.")
      .def_ro("height", &BasePlacement::height,
              "Height of the base's bottom above the target, metres.");
}

void BindPickSampler(nb::module_& m) {
  nb::class_<PickTaskSampler, TaskSampler, PyPickTaskSampler>(
      m, "PickTaskSampler",
      "Samples starts with objects settled on a support, one of them the target, and a robot "
      "beside it.\n\nA subclass may replace sample() or any of the stages, which sample() calls in "
      "this order: make_base_scene,\nchoose_kinds, choose_base_placement, place_objects, "
      "propose_base_pose, validate_base_pose, validate_cameras, make_task.")
      .def(nb::init<RunConfig>(), "run"_a)
      .def_prop_ro(
          "run", [](const PickTaskSampler& s) { return s.run(); }, "A copy of the run.")
      .def(
          "sample",
          [](PickTaskSampler& s, const SampleRequest& request, PythonRng& rng) {
            return SampleForPython(request, rng, [&](const SampleRequest& asked, Rng& stream) {
              return s.PickTaskSampler::Sample(asked, stream);
            });
          },
          "request"_a, "rng"_a,
          nb::sig("def sample(self, request: SampleRequest, rng: Rng) -> EpisodeStart | Refusal"),
          "Returns a start, or a Refusal with its stage and reason.")
      .def(
          "make_base_scene",
          [](PickTaskSampler& s, int scene) { return s.PickTaskSampler::MakeBaseScene(scene); },
          "scene_index"_a, Unlocked(), "Returns the scene without objects and robot.")
      .def(
          "annotations", [](PickTaskSampler& s, int scene) { return *s.AnnotationsOf(scene); },
          "scene_index"_a, Unlocked(),
          "Returns the SceneAnnotations of such a scene: what its source says, checked, else what "
          "follows from its geometry.")
      .def(
          "choose_kinds",
          [](PickTaskSampler& s, const SampleRequest& request, PythonRng& rng) {
            return s.PickTaskSampler::ChooseKinds(request, rng.get());
          },
          "request"_a, "rng"_a, "Returns kinds of the catalogue, the target's first.")
      .def(
          "choose_base_placement",
          [](PickTaskSampler& s, const SampleRequest& request, PythonRng& rng) {
            return s.PickTaskSampler::ChooseBasePlacement(request, rng.get());
          },
          "request"_a, "rng"_a, "Returns a place of the base relative to the target.")
      .def(
          "place_objects",
          [](PickTaskSampler& s, const Support& support, const nb::list& list, PythonRng& rng) {
            std::vector<SceneObject> objects = FromList(list);
            Rng& stream = rng.get();
            bool placed = false;
            {
              const nb::gil_scoped_release unlocked;
              placed = s.PickTaskSampler::PlaceObjects(support, objects, stream);
            }
            for (size_t i = 0; i < objects.size(); ++i)
              nb::cast<SceneObject&>(list[i]) = objects[i];
            return placed;
          },
          "support"_a, "objects"_a, "rng"_a,
          nb::sig("def place_objects(self, support: Support, objects: list[SceneObject], rng: Rng) "
                  "-> bool"),
          "Sets the objects' poses on the support. Returns False if there is no room.")
      .def(
          "propose_base_pose",
          [](PickTaskSampler& s, const Robot& robot, const Support& support, const Pose& target,
             const BasePlacement& placement, PythonRng& rng) {
            Rng& stream = rng.get();
            const nb::gil_scoped_release unlocked;
            return s.PickTaskSampler::ProposeBasePose(robot, support, target, placement, stream);
          },
          "robot"_a, "support"_a, "target_in_world"_a, "placement"_a, "rng"_a,
          "Returns a pose in the world for the bottom of the robot's base. Returns None if the "
          "robot at home would overlap the support all around the target; then the objects are "
          "placed again.")
      .def(
          "validate_base_pose",
          [](PickTaskSampler& s, Scene scene, Robot robot, const std::string& target_body) {
            const nb::gil_scoped_release release;
            return s.PickTaskSampler::ValidateBasePose(scene, robot, target_body);
          },
          "scene"_a, "robot"_a, "target_body"_a,
          "Returns None if the robot is collision-free where it stands and reaches a grasp of the "
          "target.")
      .def(
          "validate_cameras",
          [](PickTaskSampler& s, Scene scene, const std::string& target_body) {
            const nb::gil_scoped_release release;
            return s.PickTaskSampler::ValidateCameras(scene, target_body);
          },
          "scene"_a, "target_body"_a,
          "Returns None if the cameras of start.visible_from see enough of the target.")
      .def(
          "make_task",
          [](PickTaskSampler& s, const std::string& target, const std::string& kind,
             const std::vector<std::string>& objects) {
            return s.PickTaskSampler::MakeTask(target, kind, objects);
          },
          "target"_a, "kind"_a, "objects"_a,
          "Returns the task of the episode: `target` among `objects`, names in the scene.");
}

}  // namespace

void BindPick(nb::module_& m) {
  BindPickTask(m);
  BindPlanners(m);
  BindPlaces(m);
  BindPickSampler(m);
}

}  // namespace robocell::python
