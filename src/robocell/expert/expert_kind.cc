#include "robocell/expert/expert_kind.h"

#include <fmt/format.h>

#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/registry.h"
#include "robocell/base/suggestions.h"
#include "robocell/expert/navigate_expert.h"
#include "robocell/expert/pick_expert.h"
#include "robocell/expert/skill_expert_kind.h"
#include "robocell/task/held_task_config.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/task_kind.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell {
namespace {

using ExpertRegistry = Registry<std::shared_ptr<const ExpertKind>>;

ExpertRegistry& RegisteredExperts() {
  const std::shared_ptr<const ExpertKind> skills = internal::MakeSkillExpertKind();
  static ExpertRegistry registry(
      "expert", {{PickTaskConfig::kKind, internal::MakePickExpert()},
                 {PickAndPlaceTaskConfig::kKind, internal::MakePickAndPlaceExpert()},
                 {NavigateTaskConfig::kKind, internal::MakeNavigateExpert()},
                 {RelationsTaskConfig::kKind, skills},
                 {StackTaskConfig::kKind, skills},
                 {PlaceNextToTaskConfig::kKind, skills},
                 {OpenTaskConfig::kKind, skills},
                 {CloseTaskConfig::kKind, skills},
                 {PressTaskConfig::kKind, skills},
                 {PushTaskConfig::kKind, skills},
                 {InsertTaskConfig::kKind, skills},
                 {SortTaskConfig::kKind, skills},
                 {WipeTaskConfig::kKind, skills},
                 {PourTaskConfig::kKind, skills},
                 {HandoverTaskConfig::kKind, skills},
                 {CarryTaskConfig::kKind, skills}});
  return registry;
}

}  // namespace

void RegisterExpert(const std::string& kind, std::shared_ptr<const ExpertKind> expert,
                    bool replace) {
  if (!expert) throw ArgumentError("expert '" + kind + "' needs an ExpertKind that makes it");
  RegisteredExperts().Register(kind, std::move(expert), replace);
}

std::vector<std::string> ExpertKinds() { return RegisteredExperts().names(); }

std::shared_ptr<const ExpertKind> FindExpertKind(const std::string& kind) {
  if (const auto expert = RegisteredExperts().Get(kind)) return *expert;
  const bool is_policy = kind.find(':') != std::string::npos;  // as evaluations write them
  throw NotFoundError(NoSuchName("", "expert", kind, ExpertKinds()) +
                      (is_policy ? " Policies (`module:Class`) are run by `robocell evaluate`; to "
                                   "generate with one, register it as an expert"
                                 : ""));
}

std::vector<std::string> WhyNot(const Robot& robot, const std::string& kind) {
  Problems problems(robot.config().locations);
  FindExpertKind(kind)->ValidateRobot(robot, problems);
  return LinesOf(problems);
}

std::string NameOfExpert(const RunConfig& run) {
  if (!run.expert.empty()) return run.expert;
  const std::string& task = run.task.kind();
  const std::string named = FindTaskKind(task)->expert();
  if (!named.empty()) return named;
  return RegisteredExperts().Has(task) ? task : "";
}

std::shared_ptr<const ExpertKind> ExpertKindFor(const RunConfig& run) {
  const std::string kind = NameOfExpert(run);
  if (!kind.empty()) return FindExpertKind(kind);
  throw SpecError(
      fmt::format("run '{}': no expert demonstrates task '{}'; register one under this name, name "
                  "one as `expert` (there are {}), or choose a task that has one",
                  run.run, run.task.kind(), ListNames(ExpertKinds())));
}

}  // namespace robocell
