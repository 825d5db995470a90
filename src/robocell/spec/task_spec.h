// TaskSpec: what `task:` of a run file or of an environment says: the kind of task, and the fields
// of that kind (kind_fields.h).
//
//   task: {kind: pick, lift_height: 0.1}
//
//   run.task = PickTaskConfig{.lift_height = 0.1};
//   if (const auto* pick = run.task.If<PickTaskConfig>()) ...
//
// pick and pick_and_place are there; others come with RegisterTaskFields, usually by way of
// RegisterTask (task/task_kind.h).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/kind_fields.h"

namespace robocell {

KindRegistry& TaskKindRegistry();

// Makes a kind known. ArgumentError for one that is taken, unless `replace` allows it.
inline void RegisterTaskFields(const std::string& kind, std::shared_ptr<const KindFields> defaults,
                               bool replace = false) {
  TaskKindRegistry().Register(kind, std::move(defaults), replace);
}
// All kinds, in alphabetical order.
inline std::vector<std::string> TaskKinds() { return TaskKindRegistry().kinds(); }
inline bool IsTaskKind(const std::string& kind) { return TaskKindRegistry().Has(kind); }

class TaskSpec : public KindSpec {
 public:
  // Pick, with its defaults.
  TaskSpec() : TaskSpec(std::string("pick")) {}
  // A kind with its defaults. NotFoundError lists the kinds.
  explicit TaskSpec(const std::string& kind) : KindSpec(TaskKindRegistry(), kind) {}
  template <NamesItsKind T>
  TaskSpec(T fields) : TaskSpec(std::string(T::kKind)) {
    Put(std::move(fields));
  }
};

}  // namespace robocell
