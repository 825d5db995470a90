#include "robocell/task/pick_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/validate.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/reach_advice.h"

namespace robocell::internal {
namespace {

// Rejects a field that only environments have, in a run that chooses `chosen`.
void RequireUnsetInRun(const char* field, bool is_default, const char* chosen, Problems& problems) {
  if (is_default) return;
  problems.AddAt(field, fmt::format("belongs to environments, whose objects have ids and places; a "
                                    "run chooses {}: leave it out",
                                    chosen));
}

// Rejects a field that only runs have, in an environment.
void RequireUnsetInEnv(const char* field, bool is_default, Problems& problems) {
  if (is_default) return;
  problems.AddAt(field,
                 "belongs to runs, which choose objects and put the robot beside them; in an "
                 "environment the rig says where they are: leave it out");
}

// Requires an object that moves with the rig, as a task does.
void RequireRigObject(const EnvConfig& env, const char* field, const std::string& object,
                      Problems& problems) {
  if (env.root_frame_objects.contains(object)) return;
  if (!env.world_frame_objects.contains(object)) {
    return problems.AddAt(
        field, NoSuchName("root_frame_objects", "object", object, env.root_frame_objects.keys()));
  }
  problems.AddAt(field, fmt::format("'{}' is in world_frame_objects, which stay in the room; a "
                                    "task goes with the rig, and so do its objects: move it to "
                                    "root_frame_objects",
                                    object));
}

// Rejects a length that no arm reaches. What a run's arm can do is found with the robot.
void RequireMetres(const char* field, double length, Problems& problems) {
  constexpr double kMost = 5;  // m
  if (!(length > kMost)) return;
  problems.AddAt(field, fmt::format("{:g} m is more than any arm reaches, and lengths are in "
                                    "metres. Is it in millimetres? Then write {:g}",
                                    length, length / 1000));
}

void RequireKinds(const char* field, const NameList& chosen, const std::vector<std::string>& known,
                  Problems& problems) {
  const Problems::Scope scope(problems, field);
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (std::ranges::find(known, chosen[i]) != known.end()) continue;
    const Problems::Scope item(problems, i);
    problems.Add(NoSuchName("", "kind of object", chosen[i], known));
  }
}

// The common part of both kinds.
template <class Config, class T>
class KindOfPick : public TaskKindOf<Config, T> {
 public:
  bool is_built_in() const override { return true; }

  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    const auto& task = run.task.As<Config>();
    const Config plain;
    const Problems::Scope scope(problems, "task");
    constexpr const char* kObjects = "its objects among the kinds in `objects`";
    RequireUnsetInRun("object", task.object == plain.object, kObjects, problems);
    RequireUnsetInRun("spread", task.spread == plain.spread, kObjects, problems);
    RequireUnsetInRun("rotate", task.rotate == plain.rotate, kObjects, problems);
    RequireKinds("objects", task.objects, ObjectKinds(), problems);
  }
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    const auto& task = env.task->As<Config>();
    const std::vector<std::string> ids = env.root_frame_objects.keys();
    const Problems::Scope scope(problems, "task");
    ValidateNotEmpty(task.object, "object",
                     ids.empty()
                         ? "what is to be picked, by its id in root_frame_objects, where "
                           "nothing is yet"
                         : "what is to be picked, one of root_frame_objects: " + ListNames(ids),
                     problems);
    if (!task.object.empty()) RequireRigObject(env, "object", task.object, problems);
    RequireMetres("lift_height", task.lift_height, problems);
    for (const double most : task.spread) RequireMetres("spread", most, problems);
    RequireUnsetInEnv("objects", task.objects.empty(), problems);
  }
  std::vector<StartContents> PossibleContents(const RunConfig& run, int /*scene*/,
                                              const SceneSpec& /*base*/,
                                              const Task::KnownScene& /*known*/) const override {
    return ObjectTask::PossibleContents(KindsOf(run));
  }
  std::string ReachAdvice(const RunConfig& run) const override {
    return internal::ReachAdvice(run);
  }

 protected:
  // Returns the kinds that a run draws its objects from.
  static std::vector<std::string> KindsOf(const RunConfig& run) {
    const NameList& objects = run.task.As<Config>().objects;
    return objects.empty() ? ObjectKinds() : objects.names;
  }
};

using PickKind = KindOfPick<PickTaskConfig, PickTask>;

class PickAndPlaceKind final : public KindOfPick<PickAndPlaceTaskConfig, PickAndPlaceTask> {
 public:
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    KindOfPick::ValidateRun(run, problems);
    const auto& task = run.task.As<PickAndPlaceTaskConfig>();
    const PickAndPlaceTaskConfig plain;
    const Problems::Scope scope(problems, "task");
    constexpr const char* kGoals = "what they are put on among the kinds in `goals`";
    RequireUnsetInRun("goal", task.goal == plain.goal, kGoals, problems);
    RequireUnsetInRun("goal_object", task.goal_object == plain.goal_object, kGoals, problems);
    RequireUnsetInRun("goal_spread", task.goal_spread == plain.goal_spread, kGoals, problems);
    RequireKinds("goals", task.goals, PickAndPlaceTask::AllGoalKinds(), problems);
  }
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    KindOfPick::ValidateEnv(env, problems);
    const auto& task = env.task->As<PickAndPlaceTaskConfig>();
    const Problems::Scope scope(problems, "task");
    for (const double most : task.goal_spread) RequireMetres("goal_spread", most, problems);
    RequireMetres("goal_tolerance", task.goal_tolerance, problems);
    RequireMetres("goal_distance", task.goal_distance, problems);
    RequireUnsetInEnv("goals", task.goals.empty(), problems);
    if (!task.goal_object.empty()) RequireRigObject(env, "goal_object", task.goal_object, problems);
    if (!task.goal && task.goal_object.empty()) {
      problems.AddAt("goal",
                     "is required: where the object is to be put, for example [0.4, 0.2, 0], or "
                     "goal_object, what it is to be put on");
    }
    if (!task.goal_object.empty() && task.goal_object == task.object)
      problems.AddAt("goal_object", "is the object that is to be put there; name another one");
  }
  std::vector<StartContents> PossibleContents(const RunConfig& run, int /*scene*/,
                                              const SceneSpec& /*base*/,
                                              const Task::KnownScene& /*known*/) const override {
    return PickAndPlaceTask::PossibleContents(
        KindsOf(run), PickAndPlaceTask::GoalKindsOf(run.task.As<PickAndPlaceTaskConfig>()));
  }
};

}  // namespace

std::shared_ptr<const TaskKind> MakePickKind() { return std::make_shared<PickKind>(); }

std::shared_ptr<const TaskKind> MakePickAndPlaceKind() {
  return std::make_shared<PickAndPlaceKind>();
}

}  // namespace robocell::internal
