#include "robocell/spec/task_spec.h"

#include <fmt/format.h>

#include <map>
#include <mutex>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const TaskFields>> kinds = {
      {PickTaskConfig::kKind, std::make_shared<TaskFieldsOf<PickTaskConfig>>()},
      {PickAndPlaceTaskConfig::kKind, std::make_shared<TaskFieldsOf<PickAndPlaceTaskConfig>>()}};
};

Registry& Kinds() {
  static Registry registry;
  return registry;
}

std::shared_ptr<const TaskFields> Find(const std::string& kind) {
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  const auto found = registry.kinds.find(kind);
  return found == registry.kinds.end() ? nullptr : found->second;
}

}  // namespace

std::vector<std::string> TaskFields::names() const {
  std::vector<std::string> names;
  for (const TaskFieldRef& field : const_cast<TaskFields*>(this)->refs())
    names.push_back(field.name);
  return names;
}

bool TaskFields::Equals(const TaskFields& other) const {
  const auto mine = const_cast<TaskFields*>(this)->refs();
  const auto others = const_cast<TaskFields&>(other).refs();
  if (mine.size() != others.size()) return false;
  for (size_t i = 0; i < mine.size(); ++i) {
    if (mine[i].name != others[i].name || mine[i].value.index() != others[i].value.index())
      return false;
    const bool equal = std::visit(
        [&](const auto* value) {
          return *value == *std::get<std::remove_const_t<std::remove_pointer_t<decltype(value)>>*>(
                               others[i].value);
        },
        mine[i].value);
    if (!equal) return false;
  }
  return true;
}

void ValidateTask(const TaskSpec& task, Problems& problems) {
  TaskFields& fields = *task.shared_fields();
  for (const TaskFieldRef& field : fields.refs()) {
    const Problems::Scope scope(problems, field.name);
    std::visit([&](const auto* value) { ValidateValue(*value, field.check, problems); },
               field.value);
  }
  fields.Validate(problems);
}

void RegisterTaskFields(const std::string& kind, std::shared_ptr<const TaskFields> defaults,
                        bool replace) {
  if (kind.empty()) throw ArgumentError("a kind of task that is registered needs a name");
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  const bool is_new = registry.kinds.try_emplace(kind, defaults).second;
  if (is_new) return;
  if (!replace)
    throw ArgumentError("task '" + kind + "' is registered already; choose another name");
  registry.kinds[kind] = std::move(defaults);
}

std::vector<std::string> TaskKinds() {
  Registry& registry = Kinds();
  const std::lock_guard lock(registry.mutex);
  std::vector<std::string> kinds;
  for (const auto& [kind, fields] : registry.kinds) kinds.push_back(kind);
  return kinds;
}

bool IsTaskKind(const std::string& kind) { return Find(kind) != nullptr; }

TaskSpec::TaskSpec() : TaskSpec(std::string(PickTaskConfig::kKind)) {}

TaskSpec::TaskSpec(const std::string& kind) : kind_(kind) {
  const std::shared_ptr<const TaskFields> defaults = Find(kind);
  if (!defaults) throw NotFoundError(NoSuchName("", "task", kind, TaskKinds()));
  fields_ = defaults->Clone();
}

void TaskSpec::ThrowOtherKind(const char* wanted) const {
  throw SpecError(fmt::format("task: is of kind {}, where fields of {} are needed", kind_, wanted));
}

}  // namespace robocell
