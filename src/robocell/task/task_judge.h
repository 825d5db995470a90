// TaskJudge: begins a task's episodes and judges its states. Whatever runs a task goes through it,
// so that an environment, a run and RunEnv reject the same verdicts with the same error.
//
//   TaskJudge judge(*task, scene, "environment 'duo'");
//   judge.Begin();                                  // after the reset
//   const TaskVerdict verdict = judge.Judge();      // after each step
//
// Errors of these hooks are HookErrors (base/hook_error.h), as is an invalid verdict: a reward
// that is not finite, progress outside of 0 to 1, or a subtask without a name. The task has to live
// as long as its judge. One thread at a time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/task/task.h"

namespace robocell {

// Returns a warning of an instruction without words, with which episodes are recorded and which
// policies see; "" if it has any.
std::string WhyNoWords(const Task& task, const std::string& kind, const std::string& instruction);

}  // namespace robocell

namespace robocell::internal {

class TaskJudge {
 public:
  // `place` begins the messages about verdicts; "" for none.
  TaskJudge(Task& task, Scene scene, std::string place = "");
  // Begins an episode. The scene is in its start state.
  void Begin();
  TaskVerdict Judge();
  // Call it when the task has entered another episode.
  void ForgetSubtasks() { subtasks_.reset(); }
  // Returns the names of the task's subtasks in this episode.
  const std::vector<std::string>& subtasks();

 private:
  void Require(const TaskVerdict& verdict);

  Task* task_;
  Scene scene_;
  std::string place_;
  std::optional<std::vector<std::string>> subtasks_;  // once they were needed
};

// Logs WhyNoWords, once per kind and place of the code in a process.
void WarnOfNoWords(const Task& task, const std::string& kind, const std::string& instruction);

}  // namespace robocell::internal
