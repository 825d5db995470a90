// TaskSpec: `task:` of a run file or of an environment: the kind of task and the fields of that
// kind (kind_fields.h).
//
//   task: {kind: pick, lift_height: 0.1}
//
//   run.task = PickTaskConfig{.lift_height = 0.1};
//   if (const auto* pick = run.task.If<PickTaskConfig>()) ...
//
// pick and pick_and_place are built in; RegisterTaskFields adds others, usually through
// RegisterTask (task/task_kind.h).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/kind_fields.h"

namespace robocell {

KindRegistry& TaskKindRegistry();

// Registers a kind. Throws ArgumentError for a name that is taken, unless `replace` allows it.
inline void RegisterTaskFields(const std::string& kind, std::shared_ptr<const KindFields> defaults,
                               bool replace = false) {
  TaskKindRegistry().Register(kind, std::move(defaults), replace);
}
// Returns all kinds in alphabetical order.
inline std::vector<std::string> TaskKinds() { return TaskKindRegistry().kinds(); }
inline bool IsTaskKind(const std::string& kind) { return TaskKindRegistry().Has(kind); }

class TaskSpec : public KindSpec {
 public:
  // Makes a pick task with its defaults.
  TaskSpec() : TaskSpec(std::string("pick")) {}
  // Makes a kind with its defaults. Throws NotFoundError that lists the kinds.
  explicit TaskSpec(const std::string& kind) : KindSpec(TaskKindRegistry(), kind) {}
  template <NamesItsKind T>
  TaskSpec(T fields) : TaskSpec(std::string(T::kKind)) {
    Put(std::move(fields));
  }
};

}  // namespace robocell
