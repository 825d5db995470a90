// TaskCalls: calls the hooks of a task by which an episode begins, and by which it is described and
// restored. Environments and runs go through it, so that an error of a hook is the same HookError
// (base/hook_error.h) in both: it names the hook and its place. TaskJudge (task_judge.h) calls the
// hooks of the episode itself.
//
//   TaskCalls calls(*task);
//   const BodyPoses starts = calls.Starts(rng);
//   calls.Reset(scene, {.body_poses = starts});
//   if (auto refusal = calls.Arrange(scene, rng)) ...
//
// The task has to outlive it. Threads: those of the task.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/task/task.h"

namespace robocell::internal {

class TaskCalls {
 public:
  explicit TaskCalls(Task& task) : task_(task) {}

  // Calls Prepare with these annotations. Throws HookError if it added an object twice or one in
  // millimetres, or changed the timestep. `kind` names the task in messages; "" for a task without
  // one. Without a turn the scene serves all starts (Task::is_prepared_once).
  void Prepare(const Task::KnownScene& known, SceneSpec& spec, Rng& rng, const std::string& kind,
               const std::optional<StartTurn>& turn = {});
  void Bind(const Scene& scene, const TaskSetting& setting);

  BodyPoses Starts(Rng& rng);
  // Throws an error of Prepare if one of its objects needs a place and cannot be put there, and one
  // of objects() if the scene has no object of such a name.
  void RequireObjects(const Scene& scene, std::span<const SceneObject> prepared);

  // Puts bodies where Starts told. A body that cannot be there is an error of Starts.
  void Put(Scene& scene, const BodyPoses& starts);
  // Resets a scene whose `body_poses` are those of Starts, and possibly others that can be moved.
  void Reset(Scene& scene, const ResetOptions& options);
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng);
  std::optional<Refusal> CheckStart(const Scene& scene);
  // Returns the free objects of a scene that have to lie still.
  std::vector<std::string> RestingObjects(const Scene& scene);
  Map<ObjectPlace> Places();
  std::vector<std::string> Objects();
  std::string ObjectOf(const std::string& name);
  std::string KindOf(const std::string& object);

  std::string Instruction();
  std::string WhyNotDone();
  std::vector<std::string> Subtasks();

  std::vector<double> Memory();
  void Recall(std::span<const double> memory);
  bool CanRecall(std::span<const double> memory);
  std::string WhyNotRecalled(std::span<const double> memory);
  bool HoldsElsewhere(std::span<const double> memory);

 private:
  Task& task_;
};

}  // namespace robocell::internal
