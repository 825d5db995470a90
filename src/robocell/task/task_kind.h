// The kinds of tasks: what a configuration's `task: {kind: ...}` stands for. pick and pick_and_place
// are there; one's own are registered before the first configuration that names them is read:
//
//   struct StackConfig { ... kKind = "stack", Fields ... };
//   RegisterTask<StackConfig>(std::make_shared<TaskKindOf<StackConfig, Stack>>());
//
// A kind makes tasks from their fields. For generated datasets it also makes the sampler of starts,
// which is one for all tasks unless the kind has its own, and names the expert that demonstrates.
// Includes nothing of a concrete task; what runs tasks includes this file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
#include "robocell/task/task.h"

namespace robocell {

class TaskKind {
 public:
  virtual ~TaskKind() = default;
  // A task that is bound to no scene yet.
  virtual std::shared_ptr<Task> Make(const TaskSpec& spec) const = 0;
  // The starts of a run's episodes: a TaskStartSampler (start_sampler.h) unless overridden.
  virtual std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const;
  // The kind of expert that demonstrates it (expert/expert_kind.h); "" for a kind that has none.
  virtual std::string expert() const { return ""; }

  // What can be known of a run before its first episode. `scene` holds the run's robot and one of
  // each of Contents(run).
  virtual void ValidateRun(const RunConfig& /*run*/, Problems& /*problems*/) const {}
  virtual void ValidateScene(const RunConfig& /*run*/, const Scene& /*scene*/, Robot& /*robot*/,
                             Problems& /*problems*/, std::vector<std::string>& /*warnings*/) const {
  }
  // One of each kind of object that the run's scenes may hold, for their models.
  virtual std::vector<SceneObject> Contents(const RunConfig& run) const;
  // Source files that define it, for kinds that users write: a dataset remembers what they held.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
  // Whether robocell brings it: what goes wrong in its tasks is no failure of a user's code.
  virtual bool is_built_in() const { return false; }
  // What to change when every start was refused because nothing is in reach; "" when unknown.
  virtual std::string ReachAdvice(const RunConfig& /*run*/) const { return ""; }
};

// Makes a kind known on all threads, from now on. `fields` are its defaults. ArgumentError for a
// name that is taken, unless `replace` allows it.
void RegisterTask(const std::string& kind, std::shared_ptr<const KindFields> fields,
                  std::shared_ptr<const TaskKind> task, bool replace = false);

// A kind whose tasks are made as T(const Config&).
template <NamesItsKind Config, class T>
class TaskKindOf : public TaskKind {
 public:
  std::shared_ptr<Task> Make(const TaskSpec& spec) const override {
    return std::make_shared<T>(spec.As<Config>());
  }
};
template <NamesItsKind Config>
void RegisterTask(std::shared_ptr<const TaskKind> task) {
  RegisterTask(Config::kKind, std::make_shared<KindFieldsOf<Config>>(), std::move(task));
}

// NotFoundError lists the kinds, for those whose fields are registered without a task.
std::shared_ptr<const TaskKind> FindTaskKind(const std::string& kind);

// The task of an environment, bound to its scene; null without one.
std::shared_ptr<Task> MakeTask(const EnvConfig& config, const Scene& scene);
// Adds to an environment's scene what its task needs; nothing without a task.
void PrepareTask(const EnvConfig& config, SceneSpec& spec);

}  // namespace robocell
