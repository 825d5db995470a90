#include "robocell/expert/expert_kind.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/expert/pick_expert.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const ExpertKind>> kinds = {
      {PickTaskConfig::kKind, internal::MakePickExpert()},
      {PickAndPlaceTaskConfig::kKind, internal::MakePickAndPlaceExpert()}};
};

Registry& Kinds() {
  static Registry registry;
  return registry;
}

}  // namespace

void RegisterExpert(const std::string& kind, std::shared_ptr<const ExpertKind> expert,
                    bool replace) {
  if (kind.empty()) throw ArgumentError("a kind of expert that is registered needs a name");
  if (!expert) throw ArgumentError("expert '" + kind + "' needs an ExpertKind that makes it");
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  if (registry.kinds.contains(kind) && !replace)
    throw ArgumentError("expert '" + kind + "' is registered already; choose another name");
  registry.kinds[kind] = std::move(expert);
}

std::vector<std::string> ExpertKinds() {
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  std::vector<std::string> kinds;
  for (const auto& [kind, expert] : registry.kinds) kinds.push_back(kind);
  return kinds;
}

std::shared_ptr<const ExpertKind> FindExpertKind(const std::string& kind) {
  {
    Registry& registry = Kinds();
    const std::lock_guard lock(registry.mutex);
    const auto found = registry.kinds.find(kind);
    if (found != registry.kinds.end()) return found->second;
  }
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

std::shared_ptr<const ExpertKind> ExpertKindOf(const RunConfig& run) {
  const std::string kind =
      run.expert.empty() ? FindTaskKind(run.task.kind())->expert() : run.expert;
  if (!kind.empty()) return FindExpertKind(kind);
  throw SpecError(
      fmt::format("run '{}': no expert demonstrates task '{}'; register one for it, or "
                  "choose a task that has one",
                  run.run, run.task.kind()));
}

}  // namespace robocell
