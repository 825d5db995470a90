#include "robocell/task/pick_kind.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/validate.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/driving_starts.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/reach_advice.h"

namespace robocell::internal {
namespace {

// Rejects two fields that are set and exclude each other.
void RequireOnlyOne(const char* field, bool is_set, const char* other, bool is_other_set,
                    const char* what, Problems& problems) {
  if (!is_set || !is_other_set) return;
  problems.AddAt(field, fmt::format("are the kinds that {} is drawn from, and `{}` names it "
                                    "already: leave one of them out",
                                    what, other));
}

// Rejects a field that moves an object from its place, for one that has no place of its own.
void RequireNamed(const char* field, bool is_default, bool is_named, const char* names,
                  Problems& problems) {
  if (is_default || is_named) return;
  problems.AddAt(field, fmt::format("is about the place that {} has in the scene, and none is "
                                    "named: what is drawn lies anywhere on a support. Leave it "
                                    "out",
                                    names));
}

// Explains how to draw an object of a kind where the object itself is to be named; "" for others.
std::string HowToDraw(const std::string& kind) {
  const std::vector<std::string> kinds = ObjectKinds();
  if (std::ranges::find(kinds, kind) == kinds.end()) return "";
  return fmt::format(" '{0}' is a kind of object: `objects: [{0}]` in its place draws one", kind);
}

// Requires an object that moves with the rig, as a task does.
void RequireRigObject(const EnvConfig& env, const char* field, const std::string& object,
                      Problems& problems) {
  if (env.root_frame_objects.contains(object)) return;
  if (!env.world_frame_objects.contains(object)) {
    return problems.AddAt(
        field, NoSuchName("root_frame_objects", "object", object, env.root_frame_objects.keys()) +
                   (field == std::string_view("object") ? HowToDraw(object) : ""));
  }
  problems.AddAt(field, fmt::format("'{}' is in world_frame_objects, which stay in the room; a "
                                    "task goes with the rig, and so do its objects: move it to "
                                    "root_frame_objects",
                                    object));
}

// Rejects an object of the rig with the name of one that the task adds, as `part` ("target"), of one
// of these kinds.
void RequireFreeNames(const EnvConfig& env, const std::string& part,
                      const std::vector<std::string>& kinds, const std::string& field,
                      Problems& problems) {
  std::set<std::string> taken = {part};
  for (const std::string& kind : kinds) taken.insert(fmt::format("{}_{}", part, kind));
  const auto check = [&](const Map<EnvObject>& objects) {
    for (const std::string& name : objects.keys()) {
      if (!taken.contains(name)) continue;
      problems.AddAt(name, fmt::format("task '{}' gives this name to an object that it draws; "
                                       "choose another name, or let the task use this object: "
                                       "task.{}: {}",
                                       env.task->kind(), field, name));
    }
  };
  for (const auto& [path, objects] : {std::pair{"root_frame_objects", &env.root_frame_objects},
                                      std::pair{"world_frame_objects", &env.world_frame_objects}}) {
    const Problems::Scope scope(problems, path);
    check(*objects);
  }
  const Problems::Scope of_robots(problems, "robot_frame_objects");
  for (const auto& [robot, objects] : env.robot_frame_objects.entries()) {
    const Problems::Scope scope(problems, robot);
    check(*objects);
  }
}

// Requires an object that all scenes of a run have themselves.
// `scene`: the first of them, compiled.
void RequireObjectOfScenes(const RunConfig& run, const Scene& scene, const char* field,
                           const std::string& object, Problems& problems) {
  if (object.empty()) return;
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  for (const int index : SceneIndices(run)) {
    std::vector<std::string> known;
    for (const SceneObject& each : MakeBaseScene(run, *source, index).objects)
      known.push_back(each.name);
    if (std::ranges::find(known, object) != known.end()) continue;
    const std::string how_to_draw = field == std::string_view("object") ? HowToDraw(object) : "";
    const std::string place = fmt::format("scene {} of source '{}'", index, run.scenes.kind());
    if (!known.empty())
      return problems.AddAt(field, NoSuchName(place, "object", object, known) + how_to_draw);
    const bool is_body = FindId(scene.model(), mjOBJ_BODY, object) >= 0;
    return problems.AddAt(
        field,
        fmt::format(
            "no object '{}': {} has no objects, which a source puts into "
            "SceneSpec.objects{}. Leave `{}` out, so that the task draws objects of the "
            "catalogue, or register a source of your own that adds the object, as "
            "docs/tasks.md shows{}",
            object, place,
            is_body ? ", and a body of its model file is none: give it a file of its own" : "",
            field, how_to_draw.empty() ? "" : "." + how_to_draw));
  }
}

// Rejects a goal at which kinds of objects that the task draws cannot come to rest. `scene` has one
// of each kind, which is named by it.
void RequireRestAtGoal(const PickAndPlaceTaskConfig& task, const Scene& scene, Problems& problems) {
  std::vector<std::string> wrong;
  std::string why;
  const auto& objects = scene.compiled()->objects();
  for (const std::string& kind : KindsToDraw(task.objects)) {
    const auto object = std::ranges::find(objects, kind, &ObjectRecord::name);
    if (object == objects.end() || !object->free_joint) continue;  // the scene's own has the name
    PickAndPlaceTaskConfig one = task;
    one.object = kind;
    one.objects = {};
    PickAndPlaceTask placing(one);
    placing.Bind(scene, {.place = "task", .robots = {}, .is_run = true});
    const std::string why_not = placing.WhyNoRest(scene, kind);
    if (why_not.empty()) continue;
    if (wrong.empty()) why = why_not;
    wrong.push_back(kind);
  }
  if (wrong.empty()) return;
  problems.AddAt(
      "goal", fmt::format("{} cannot come to rest there ('{}': {}). Give the position of the "
                          "object's root at rest, which fits the height of each kind of `objects` "
                          "within `goal_tolerance` ({:g} m)",
                          ListNames(wrong), wrong.front(), why, task.goal_tolerance));
}

// Rejects a length that no arm reaches. What a run's arm can do is found with the robot.
void RequireMetres(const char* field, double length, Problems& problems) {
  constexpr double kMost = 5;  // m
  if (!(length > kMost)) return;
  problems.AddAt(field, fmt::format("{:g} m is more than any arm reaches, and lengths are in "
                                    "metres. Is it in millimetres? Then write {:g}",
                                    length, length / 1000));
}

// Requires kinds or categories. `kinds` are the allowed ones.
void RequireKinds(const char* field, const NameList& chosen, const std::vector<std::string>& kinds,
                  Problems& problems) {
  if (chosen.empty()) return;
  const Problems::Scope scope(problems, field);
  std::vector<std::string> categories;
  for (const auto& [category, members] : ObjectCategories()) categories.push_back(category);
  std::vector<std::string> known = kinds;
  known.insert(known.end(), categories.begin(), categories.end());
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (std::ranges::find(known, chosen[i]) != known.end()) continue;
    const Problems::Scope item(problems, i);
    problems.Add(NoSuchName("", "kind of object", chosen[i], known) +
                 " Categories, which stand for all their kinds: " + ListNames(categories, 20));
  }
}

// The common part of both kinds.
template <class Config, class T>
class KindOfPick : public TaskKindOf<Config, T> {
 public:
  bool is_built_in() const override { return true; }
  std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const override {
    return MakeSamplerOfWork(run);
  }

  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    const Problems::Scope scope(problems, "task");
    const auto& task = run.task.As<Config>();
    ValidateTask(task, problems);
    std::vector<std::string> arms = ArmNames(run.robot.config);
    arms.emplace_back(kAnyArm);
    if (!task.arm.empty() && std::ranges::find(arms, task.arm) == arms.end())
      problems.AddAt("arm",
                     NoSuchName("robot '" + run.robot.config.name + "'", "arm", task.arm, arms));
  }
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    const auto& task = env.task->As<Config>();
    if (task.object.empty())
      RequireFreeNames(env, kTarget, KindsToDraw(task.objects), "object", problems);
    const Problems::Scope scope(problems, "task");
    ValidateTask(task, problems);
    if (!task.arm.empty())
      problems.AddAt("arm",
                     "is of runs, whose expert acts with it; actions move all arms of an "
                     "environment: leave it out");
    if (!task.object.empty()) RequireRigObject(env, "object", task.object, problems);
  }
  void ValidateScene(const RunConfig& run, const Scene& scene, Robot& /*robot*/, Problems& problems,
                     Problems& /*doubts*/) const override {
    const Problems::Scope scope(problems, "task");
    RequireObjectOfScenes(run, scene, "object", run.task.As<Config>().object, problems);
  }
  std::vector<StartContents> PossibleContents(const RunConfig& run, int /*scene*/,
                                              const SceneSpec& /*base*/,
                                              const Task::KnownScene& /*known*/) const override {
    return Picks(run.task.As<Config>());
  }
  ReachAdvice AdviseReach(const RunConfig& run) const override {
    return internal::AdviseReach(run);
  }

 protected:
  // The rules of runs and environments.
  virtual void ValidateTask(const Config& task, Problems& problems) const {
    const Config plain;
    const bool is_named = !task.object.empty();
    RequireOnlyOne("objects", !task.objects.empty(), "object", is_named, "the object", problems);
    RequireNamed("spread", task.spread == plain.spread, is_named, "`object`", problems);
    RequireNamed("rotate", task.rotate == plain.rotate, is_named, "`object`", problems);
    RequireKinds("objects", task.objects, ObjectKinds(), problems);
    RequireMetres("lift_height", task.lift_height, problems);
    for (const double most : task.spread) RequireMetres("spread", most, problems);
  }
  // Returns the drawn objects that a start may have; one without any if the task names its object.
  static std::vector<StartContents> Picks(const Config& task) {
    if (!task.object.empty()) return {StartContents()};
    return ObjectTask::PossibleContents(KindsToDraw(task.objects));
  }
};

using PickKind = KindOfPick<PickTaskConfig, PickTask>;

class PickAndPlaceKind final : public KindOfPick<PickAndPlaceTaskConfig, PickAndPlaceTask> {
 public:
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    KindOfPick::ValidateEnv(env, problems);
    const auto& task = env.task->As<PickAndPlaceTaskConfig>();
    if (!task.goal && task.goal_object.empty())
      RequireFreeNames(env, kGoal, PickAndPlaceTask::GoalKindsOf(task), "goal_object", problems);
    const Problems::Scope scope(problems, "task");
    if (!task.goal_object.empty()) RequireRigObject(env, "goal_object", task.goal_object, problems);
  }
  void ValidateScene(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                     Problems& doubts) const override {
    KindOfPick::ValidateScene(run, scene, robot, problems, doubts);
    const Problems::Scope scope(problems, "task");
    const auto& task = run.task.As<PickAndPlaceTaskConfig>();
    RequireObjectOfScenes(run, scene, "goal_object", task.goal_object, problems);
    if (task.object.empty() && task.goal && task.goal_object.empty())
      RequireRestAtGoal(task, scene, problems);
  }
  std::vector<StartContents> PossibleContents(const RunConfig& run, int /*scene*/,
                                              const SceneSpec& /*base*/,
                                              const Task::KnownScene& /*known*/) const override {
    const auto& task = run.task.As<PickAndPlaceTaskConfig>();
    const std::vector<StartContents> picks = Picks(task);
    if (task.goal || !task.goal_object.empty()) return picks;
    return PickAndPlaceTask::WithGoals(picks, PickAndPlaceTask::GoalKindsOf(task));
  }

 protected:
  void ValidateTask(const PickAndPlaceTaskConfig& task, Problems& problems) const override {
    KindOfPick::ValidateTask(task, problems);
    const PickAndPlaceTaskConfig plain;
    const bool is_named = task.goal || !task.goal_object.empty();
    RequireOnlyOne("goals", !task.goals.empty(), task.goal ? "goal" : "goal_object", is_named,
                   "the goal", problems);
    RequireNamed("goal_spread", task.goal_spread == plain.goal_spread, is_named,
                 "`goal` or `goal_object`", problems);
    RequireKinds("goals", task.goals, PickAndPlaceTask::AllGoalKinds(), problems);
    for (const double most : task.goal_spread) RequireMetres("goal_spread", most, problems);
    RequireMetres("goal_tolerance", task.goal_tolerance, problems);
    RequireMetres("goal_distance", task.goal_distance, problems);
    if (!task.goal_object.empty() && task.goal_object == task.object)
      problems.AddAt("goal_object", "is the object that is to be put there; name another one");
  }
};

}  // namespace

std::shared_ptr<const TaskKind> MakePickKind() { return std::make_shared<PickKind>(); }

std::shared_ptr<const TaskKind> MakePickAndPlaceKind() {
  return std::make_shared<PickAndPlaceKind>();
}

}  // namespace robocell::internal
