#include "robocell/task/relation_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/robot/robot.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/validate.h"
#include "robocell/task/held_relation.h"
#include "robocell/task/held_task_config.h"
#include "robocell/task/held_tasks.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/relation_tasks.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/task_kind.h"
#include "robocell/task/two_arm_task_config.h"
#include "robocell/task/two_arm_tasks.h"

namespace robocell::internal {
namespace {

void RequireKindsOfObjects(const char* field, const NameList& chosen,
                           const std::vector<std::string>& known, Problems& problems) {
  const Problems::Scope scope(problems, field);
  for (size_t i = 0; i < chosen.size(); ++i) {
    const size_t at = chosen[i].find('=');
    const std::string kind = at == std::string::npos ? chosen[i] : chosen[i].substr(at + 1);
    // A category stands for its kinds, of which one is drawn.
    const std::vector<std::string> kinds = ObjectKindsOf({kind});
    const auto is_known = [&](const std::string& each) {
      return std::ranges::find(known, each) != known.end();
    };
    if (std::ranges::all_of(kinds, is_known)) continue;
    const Problems::Scope item(problems, i);
    problems.Add(NoSuchName("", "kind of object", kind, known));
  }
}

void CheckFields(const RelationsTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, PickAndPlaceTask::AllGoalKinds(), problems);
  std::set<std::string> names;
  const Problems::Scope scope(problems, "objects");
  for (size_t i = 0; i < task.objects.size(); ++i) {
    const std::string name = task.objects[i].substr(0, task.objects[i].find('='));
    const Problems::Scope item(problems, i);
    if (!names.insert(name).second)
      problems.Add(
          fmt::format("has the name '{}' of another one; write `name=kind` to name it", name));
  }
}
void CheckFields(const StackTaskConfig& /*task*/, Problems& /*problems*/) {}
void CheckFields(const PlaceNextToTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, ObjectKinds(), problems);
  RequireKindsOfObjects("references", task.references, PickAndPlaceTask::AllGoalKinds(), problems);
}
void CheckFields(const PushTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, ObjectKinds(), problems);
}
void CheckFields(const HandoverTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, ObjectKinds(), problems);
}
void CheckFields(const CarryTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, PickAndPlaceTask::AllGoalKinds(), problems);
}
void CheckFields(const InsertTaskConfig& /*task*/, Problems& /*problems*/) {}
void CheckFields(const SortTaskConfig& /*task*/, Problems& /*problems*/) {}
void CheckFields(const WipeTaskConfig& /*task*/, Problems& /*problems*/) {}
// Rejects kinds of the catalogue and of equipment that are no vessels for the task.
void RequireVessels(const char* field, const NameList& chosen,
                    const std::function<std::string(const std::string&)>& why_not,
                    Problems& problems) {
  const std::vector<std::string> known = PickAndPlaceTask::AllGoalKinds();
  const Problems::Scope scope(problems, field);
  for (size_t i = 0; i < chosen.size(); ++i) {
    const Problems::Scope item(problems, i);
    for (const std::string& kind : ObjectKindsOf({chosen[i]})) {
      if (std::ranges::find(known, kind) == known.end()) continue;  // reported already
      const std::string why = why_not(kind);
      if (why.empty()) continue;
      problems.Add(why);
      break;
    }
  }
}

void CheckFields(const PourTaskConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, PickAndPlaceTask::AllGoalKinds(), problems);
  RequireKindsOfObjects("receivers", task.receivers, PickAndPlaceTask::AllGoalKinds(), problems);
  const auto why_not_from = [&](const std::string& kind) {
    return PourTask::WhyNotFrom(kind, task);
  };
  RequireVessels("objects", task.objects, why_not_from, problems);
  if (task.objects.empty()) {
    if (const std::string why = why_not_from(PourTask::kDefaultVessel); !why.empty())
      problems.AddAt("grains", why);
  }
  RequireVessels("receivers", task.receivers, &PourTask::WhyNotInto, problems);
}
template <class JointConfig>
void CheckFields(const JointConfig& task, Problems& problems) {
  RequireKindsOfObjects("objects", task.objects, PickAndPlaceTask::AllGoalKinds(), problems);
  if (!task.object.empty() && !task.objects.empty())
    problems.AddAt("objects",
                   "are the kinds that the object is drawn from, and `object` names it "
                   "already: leave one of them out");
}

template <class Config, class T>
class RelationKindOf final : public TaskKindOf<Config, T> {
 public:
  bool is_built_in() const override { return true; }
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    const Problems::Scope scope(problems, "task");
    CheckFields(run.task.As<Config>(), problems);
  }
  void ValidateEnv(const EnvConfig& env, Problems& problems) const override {
    const Problems::Scope scope(problems, "task");
    CheckFields(env.task->As<Config>(), problems);
  }
  void ValidateScene(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                     Problems& /*doubts*/) const override {
    if constexpr (requires { T::kArms; }) {
      const std::vector<std::string> arms = ArmsWithHands(scene, {robot.name()});
      const auto hands = std::ranges::count_if(
          arms, [&](const std::string& arm) { return Robot::Of(scene, arm).has_gripper(); });
      if (hands >= T::kArms) return;
      problems.AddAt(
          "robot", fmt::format("has {} with a gripper, and task '{}' is for two. Make one robot of "
                               "two arms, as examples/duo/duo.yaml does",
                               Counted(hands, "arm"), run.task.kind()));
    }
  }
};

template <class Config, class T>
void AddKind(KindRegistry::Kinds& kinds) {
  kinds[Config::kKind] = {std::make_shared<KindFieldsOf<Config>>(),
                          std::make_shared<RelationKindOf<Config, T>>()};
}

}  // namespace

void AddRelationKinds(KindRegistry::Kinds& kinds) {
  RegisterTaskRelations();
  AddKind<RelationsTaskConfig, RelationsTask>(kinds);
  AddKind<StackTaskConfig, StackTask>(kinds);
  AddKind<PlaceNextToTaskConfig, PlaceNextToTask>(kinds);
  AddKind<OpenTaskConfig, JointTask>(kinds);
  AddKind<CloseTaskConfig, JointTask>(kinds);
  AddKind<PressTaskConfig, JointTask>(kinds);
  AddKind<PushTaskConfig, PushTask>(kinds);
  AddKind<InsertTaskConfig, InsertTask>(kinds);
  AddKind<SortTaskConfig, SortTask>(kinds);
  AddKind<WipeTaskConfig, WipeTask>(kinds);
  AddKind<PourTaskConfig, PourTask>(kinds);
  AddKind<HandoverTaskConfig, HandoverTask>(kinds);
  AddKind<CarryTaskConfig, CarryTask>(kinds);
}

}  // namespace robocell::internal
