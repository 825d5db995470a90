#include "robocell/task/task_features.h"

#include <utility>

namespace robocell {
namespace {

class TaskFeatureSource final : public FeatureSource {
 public:
  TaskFeatureSource(Scene scene, std::shared_ptr<const Task> task,
                    const std::vector<TaskSignal>& signals)
      : scene_(std::move(scene)), task_(std::move(task)) {
    for (const TaskSignal& signal : signals) {
      Add({.column = {.name = "task/" + signal.name,
                      .shape = {static_cast<int64_t>(signal.lower.size())}},
           .role = FeatureRole::kPrivileged,
           .lower = signal.lower,
           .upper = signal.upper,
           .source = "task"});
    }
  }
  void Read(std::span<double> out) override { task_->Observe(scene_, out); }

 private:
  Scene scene_;
  std::shared_ptr<const Task> task_;
};

}  // namespace

CellFeatures FeaturesOfCell(const Scene& scene, const std::vector<Robot>& robots,
                            std::shared_ptr<const Task> task, const std::vector<std::string>& own) {
  CellFeatureOptions options{.own = own};
  if (task) {
    options.objects = task->objects();
    if (const std::vector<TaskSignal> signals = task->signals(); !signals.empty())
      options.more = std::make_unique<TaskFeatureSource>(scene, std::move(task), signals);
  }
  return {scene, robots, std::move(options)};
}

}  // namespace robocell
