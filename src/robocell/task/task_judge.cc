#include "robocell/task/task_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

// Progress may be off by this much, the rounding of sums and quotients.
constexpr double kProgressRounding = 1e-9;

std::string AllowedSubtasks(const std::vector<std::string>& names) {
  if (names.empty()) return "subtasks() is empty, so it must be 0";
  return fmt::format("it must be 0 to {}, an index into subtasks(): {}", names.size() - 1,
                     ListNames(names));
}

}  // namespace

TaskJudge::TaskJudge(Task& task, Scene scene, std::string place)
    : task_(&task), scene_(std::move(scene)), place_(std::move(place)) {
  if (!place_.empty()) place_ += ": ";
}

void TaskJudge::Begin() {
  subtasks_.reset();
  CallHook(*task_, "begin", [&] { task_->Begin(scene_.outer()); });
}

const std::vector<std::string>& TaskJudge::subtasks() {
  if (!subtasks_) subtasks_ = CallHook(*task_, "subtasks", [&] { return task_->subtasks(); });
  return *subtasks_;
}

TaskVerdict TaskJudge::Judge() {
  return CallHook(*task_, "judge", [&] {
    TaskVerdict verdict = task_->Judge(scene_.outer());
    Require(verdict);
    verdict.progress = std::clamp(verdict.progress, 0.0, 1.0);
    return verdict;
  });
}

void TaskJudge::Require(const TaskVerdict& verdict) {
  if (!std::isfinite(verdict.reward)) {
    throw ArgumentError(
        fmt::format("{}the task's reward() is {} at t = {:.3f} s; rewards must be finite numbers",
                    place_, verdict.reward, scene_.time()));
  }
  if (!(std::abs(verdict.progress - 0.5) <= 0.5 + kProgressRounding)) {
    throw ArgumentError(
        fmt::format("{}the task's progress is {} at t = {:.3f} s; it must be a number from 0 to 1",
                    place_, verdict.progress, scene_.time()));
  }
  // Index 0 is always valid, and the only one that most tasks use: their names are not needed.
  if (verdict.subtask == 0) return;
  const int count = static_cast<int>(subtasks().size());
  if (verdict.subtask > 0 && verdict.subtask < count) return;
  throw ArgumentError(fmt::format("{}the task's subtask is {}; {}", place_, verdict.subtask,
                                  AllowedSubtasks(subtasks())));
}

}  // namespace robocell::internal
