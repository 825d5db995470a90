// The pick task and the scripted planners, which can be subclassed in Python, and the relations of
// goals.
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "grasps.h"
#include "rng.h"
#include "task_trampolines.h"
#include "robocell/expert/pick_and_place_planner.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/scenes/relations.h"
#include "robocell/spec/task_spec.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/pick_task.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

class PyPickTask : public PyTaskOf<PickTask> {
 public:
  using PyTaskOf<PickTask>::PyTaskOf;

  std::vector<std::string> ChooseKinds(Rng& rng) override {
    return CallWithRng<std::vector<std::string>>(
        nb_trampoline, "choose_kinds", static_cast<PickTask*>(this),
        [&](auto* self) { return self->PickTask::ChooseKinds(rng); }, rng);
  }
};

void BindPickTask(nb::module_& m) {
  nb::class_<PickTask, Task, PyPickTask>(
      m, "PickTask",
      "A task to pick up an object. Success: it is lift_height (m) above its start while robots "
      "hold it:\nnothing else touches it, and a gripper has it between its fingers, or several "
      "robots have\nit between them. The reward, 0 to 1, is half for a TCP near the object and "
      "half for its\nheight; at success it is 1.")
      .def(nb::init<const PickTaskConfig&>(), "fields"_a,
           "The task of a run or an environment. Without `object` it draws its objects in "
           "prepare().")
      .def(
          nb::init<std::string, std::string, std::vector<std::string>, double>(), "object"_a,
          "kind"_a, "all_objects"_a, "lift_height"_a = kLiftHeight,
          "The task in a scene that has the object already: `object` is its name there, `kind` its "
          "word in the instruction, and `all_objects` are those whose poses are observed.")
      .def(
          "prepare",
          [](PickTask& t, SceneSpec& spec, PythonRng& rng) {
            t.PickTask::Prepare(spec, rng.get());
          },
          "spec"_a, "rng"_a,
          "Adds objects of the kinds that choose_kinds returns, unless the task names its object.")
      .def(
          "choose_kinds",
          [](PickTask& t, PythonRng& rng) { return t.PickTask::ChooseKinds(rng.get()); }, "rng"_a,
          "Returns kinds of the catalogue for the objects of a start, the target's first: the one "
          "whose turn it is, and up to two others.")
      .def(
          "kind_of",
          [](const PickTask& t, const std::string& object) { return t.PickTask::kind_of(object); },
          "object"_a, "Returns the kind of an object that prepare added, else its name.")
      .def(
          "check_start",
          [](PickTask& t, const Scene& scene) {
            const nb::gil_scoped_release release;
            return t.PickTask::CheckStart(scene);
          },
          "scene"_a, "Returns a Refusal if no grasp of the drawn target is in reach, else None.")
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
          "object_of",
          [](const PickTask& t, const std::string& name) { return t.PickTask::object_of(name); },
          "name"_a, "Returns the object of the scene for which a name of objects() stands.")
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
      "and picks\nup a slipped object again. It needs a task of kind pick_and_place.");
}

void BindRelationLanguage(nb::module_& m) {
  TaskKinds();  // with them `held` is registered
  m.def("relations", &RelationNames,
        "Returns the names of the relations of goals and starts: \"on\", \"inside\", ...");
  m.def(
      "relation_holds",
      [](const Scene& scene, const std::string& relation) {
        scene.SyncPoses();
        return BindRelation(scene, ParseRelation(relation))->Holds();
      },
      "scene"_a, "relation"_a,
      "Returns True if a relation holds in the scene's present state, such as \"mug on tray\". "
      "Raises "
      "ArgumentError for a sentence that is no relation, NotFoundError for unknown names."
      "\n\nExamples:\n"
      "    >>> rc.tasks.relation_holds(scene, \"cube next_to base_link 0.1\")\n"
      "    False");
  m.def(
      "relation_poses",
      [](const Scene& scene, const std::string& relation, PythonRng& rng, int count) {
        constexpr int kMost = 10000;
        if (count < 1 || count > kMost)
          throw ArgumentError(
              fmt::format("count: expected a number from 1 to {}, got {}", kMost, count));
        scene.SyncPoses();
        return BindRelation(scene, ParseRelation(relation))->Sample(rng.get(), count).poses;
      },
      "scene"_a, "relation"_a, "rng"_a, "count"_a = 16,
      nb::sig("def relation_poses(scene: Scene, relation: str, rng: Rng, count: int = 16) -> "
              "list[Pose]"),
      "Returns at most `count` poses of the subject's root in the world in which the relation "
      "holds, with everything else as it is now and none inside of something else. Empty for "
      "relations about joints.");
}

}  // namespace

void BindPick(nb::module_& m) {
  const nb::object reasons = m.attr("RefusalReason");  // of check_grasps
  reasons.attr("NO_GRASP") = kNoGrasp;
  reasons.attr("GRASPS_IN_COLLISION") = kGraspsInCollision;
  BindPickTask(m);
  m.def(
      "check_grasps",
      [](const Scene& scene, const Robot& robot, const std::string& object, double lift_height) {
        const std::string body = scene.compiled()->object(object).root_body;
        const nb::gil_scoped_release release;
        return GraspCheck().Check(scene, robot, body, lift_height);
      },
      "scene"_a, "robot"_a, "object"_a, "lift_height"_a = kLiftHeight,
      "Returns a Refusal if the robot can grasp an object in no way from where it stands, with a "
      "lift by lift_height (m), else None. For check_start of a Task."
      "\n\nExamples:\n"
      "    >>> class Carry(rc.tasks.Task):\n"
      "    ...     def check_start(self, scene):\n"
      "    ...         return rc.tasks.check_grasps(scene, scene.robot(\"rc7\"), \"cup\")");
  BindPlanners(m);
  BindGrasps(m);
  BindRelationLanguage(m);
}

}  // namespace robocell::python
