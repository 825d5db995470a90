#include "robocell/task/task_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <mutex>
#include <set>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/task/task_calls.h"

namespace robocell {

std::string WhyNoWords(const Task& task, const std::string& kind, const std::string& instruction) {
  const auto is_blank = [](unsigned char c) { return std::isspace(c) != 0; };
  if (!std::ranges::all_of(instruction, is_blank)) return "";
  const std::string place = task.PlaceOfHook("instruction");
  return fmt::format(
      "task '{}': instruction() has no words, and episodes are recorded and policies act without "
      "any; return what is to be done, such as 'pick up the mug'{}",
      kind, place.empty() ? "" : " (" + place + ")");
}

}  // namespace robocell

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
  if (!subtasks_) subtasks_ = TaskCalls(*task_).Subtasks();
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

void WarnOfNoWords(const Task& task, const std::string& kind, const std::string& instruction) {
  const std::string why = WhyNoWords(task, kind, instruction);
  if (why.empty()) return;
  static std::mutex mutex;
  static std::set<std::string> warned;
  {
    const std::lock_guard lock(mutex);
    if (!warned.insert(why).second) return;
  }
  LogWarn(why);
}

void TaskJudge::Require(const TaskVerdict& verdict) {
  if (!std::isfinite(verdict.reward)) {
    throw ArgumentError(
        fmt::format("{}the task's reward is {} at t = {:.3f} s; rewards must be finite numbers",
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
