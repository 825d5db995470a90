// The kinds of tasks: what a configuration's `task: {kind: ...}` stands for. pick and
// pick_and_place are built in; custom kinds are registered before the first configuration that
// names them is read:
//
//   struct StackConfig { ... kKind = "stack", Fields ... };
//   RegisterTask<StackConfig>(std::make_shared<TaskKindOf<StackConfig, Stack>>());
//
// A kind makes tasks from their fields. For generated datasets it also makes the sampler of starts,
// which is the same for all tasks unless the kind overrides it, and names the expert that
// demonstrates; the built-in kinds override nothing of this. This file includes no concrete task; the code that runs tasks includes it.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
#include "robocell/task/start_contents.h"
#include "robocell/task/task.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

// How much of a task is in reach from the best stand of the robot.
enum class ReachedPart { kUnknown, kNothing, kGrasp, kPregrasp, kAll };

// Where a robot has to stand so that its task is in reach, collisions aside.
struct ReachAdvice {
  std::string text = {};  // what to change; "" when unknown
  ReachedPart reached = ReachedPart::kUnknown;
  // Unless nothing is in reach: start.base_height_offset, m, and the nearest and the farthest
  // start.base_distance, m.
  double height_offset = 0;
  std::array<double, 2> distance = {};
};

// KindRules checks the fields when a run or an environment is read; the checks here need more.
class TaskKind : public KindRules {
 public:
  // Returns a task that is not bound to a scene yet.
  virtual std::shared_ptr<Task> Make(const TaskSpec& spec) const = 0;
  // Returns the sampler of a run's starts: a StartSampler (start_sampler.h) unless overridden.
  virtual std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const;
  // Returns the kind of expert that demonstrates it (expert/expert_kind.h); "" for the one that is
  // registered under the task's name, if there is one.
  virtual std::string expert() const { return ""; }

  // Checks a run with its scene, which holds the run's robot and one of each of Contents(run).
  // Settings that are valid but probably unintended become `doubts`.
  virtual void ValidateScene(const RunConfig& /*run*/, const Scene& /*scene*/, Robot& /*robot*/,
                             Problems& /*problems*/, Problems& /*doubts*/) const {}
  // Returns a few contents that together cover all objects that starts in a scene may have, for
  // checks before the first start. Default: what Prepare adds until everything that takes turns
  // (StartTurn) has come, so that a kind which draws rare objects at random overrides it. `base`: the
  // scene without them.
  virtual std::vector<StartContents> PossibleContents(const RunConfig& run, int scene,
                                                      const SceneSpec& base,
                                                      const Task::KnownScene& known) const;
  // Returns one of each kind of object that the run's scenes may hold, for their models.
  std::vector<SceneObject> Contents(const RunConfig& run) const;
  // Returns the source files that define a custom kind; a dataset stores their contents.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
  // Returns true for a built-in kind, whose errors are not failures of a user's code.
  virtual bool is_built_in() const { return false; }
  // Returns what to change when every start was refused because nothing is in reach.
  virtual ReachAdvice AdviseReach(const RunConfig& /*run*/) const { return {}; }
};

// Registers a kind for all threads. `fields` are its defaults. Throws ArgumentError for a name that
// is taken, unless `replace` allows it.
void RegisterTask(const std::string& kind, std::shared_ptr<const KindFields> fields,
                  std::shared_ptr<const TaskKind> task, bool replace = false);

// A kind that makes its tasks as T(const Config&).
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

// Returns the kind. Throws NotFoundError that lists the kinds, and for one that is registered in the
// registry of fields alone.
std::shared_ptr<const TaskKind> FindTaskKind(const std::string& kind);

// Returns the task of an environment, bound to its scene; null if it has none.
std::shared_ptr<Task> MakeTask(const EnvConfig& config, const Scene& scene);
// Adds what its task needs to an environment's scene, if it has a task.
void PrepareTask(const EnvConfig& config, SceneSpec& spec);

}  // namespace robocell
