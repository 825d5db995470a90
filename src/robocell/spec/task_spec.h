// TaskSpec: `task:` of a run file or of an environment: the kind of task and the fields of that
// kind (kind_fields.h).
//
//   task: {kind: pick, lift_height: 0.1}
//
//   run.task = PickTaskConfig{.lift_height = 0.1};
//   if (const auto* pick = run.task.If<PickTaskConfig>()) ...
//
// pick and pick_and_place are built in (task/pick_task_config.h); RegisterTask (task/task_kind.h)
// adds others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/kind_fields.h"

namespace robocell {

// The kinds of tasks. task/task_kind.cc defines it, and has the built-in ones.
KindRegistry& TaskKindRegistry();

// Returns all kinds in alphabetical order.
inline std::vector<std::string> TaskKinds() { return TaskKindRegistry().kinds(); }

class TaskSpec : public KindSpec {
 public:
  // Makes a task of the registry's default kind.
  TaskSpec() : TaskSpec(TaskKindRegistry().default_kind()) {}
  // Makes a kind with its defaults. Throws NotFoundError that lists the kinds.
  explicit TaskSpec(const std::string& kind) : KindSpec(TaskKindRegistry(), kind) {}
  template <NamesItsKind T>
  TaskSpec(T fields) : TaskSpec(std::string(T::kKind)) {
    Put(std::move(fields));
  }
};

}  // namespace robocell
