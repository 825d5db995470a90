#include "robocell/task/pick_kind.h"

#include <algorithm>

#include "robocell/base/names.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/pick_and_place_sampler.h"
#include "robocell/task/pick_sampler.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/reach_advice.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

// What pick and pick_and_place have in common.
template <class Config, class T, class Sampler>
class KindOfPick : public TaskKindOf<Config, T> {
 public:
  std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const override {
    return std::make_shared<Sampler>(run);
  }
  std::string expert() const override { return Config::kKind; }
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    ValidateKinds("task.objects", PickRunOf(run.task)->objects, ObjectKinds(), problems);
  }
  // One of each kind that may be drawn, called as its kind.
  std::vector<SceneObject> Contents(const RunConfig& run) const override {
    const NameList objects = PickRunOf(run.task)->objects;
    Rng rng = Rng::Stream(0, "check");
    std::vector<SceneObject> contents;
    for (const std::string& kind : objects.empty() ? ObjectKinds() : objects.names)
      contents.push_back(MakeCatalogueObject(kind, kind, rng));
    return contents;
  }
  std::string ReachAdvice(const RunConfig& run) const override {
    return robocell::ReachAdvice(run);
  }

 protected:
  static void ValidateKinds(const char* field, const NameList& chosen,
                            const std::vector<std::string>& known, Problems& problems) {
    Problems::Scope scope(problems, field);
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (std::ranges::find(known, chosen[i]) != known.end()) continue;
      Problems::Scope item(problems, i);
      problems.Add(NoSuchName("task", "kind", chosen[i], known));
    }
  }
};

using PickKind = KindOfPick<PickTaskConfig, PickTask, PickTaskSampler>;

class PickAndPlaceKind final
    : public KindOfPick<PickAndPlaceTaskConfig, PickAndPlaceTask, PickAndPlaceSampler> {
 public:
  void ValidateRun(const RunConfig& run, Problems& problems) const override {
    KindOfPick::ValidateRun(run, problems);
    ValidateKinds("task.goals", run.task.As<PickAndPlaceTaskConfig>().goals, AllGoalKinds(),
                  problems);
  }
  std::vector<SceneObject> Contents(const RunConfig& run) const override {
    std::vector<SceneObject> contents = KindOfPick::Contents(run);
    Rng rng = Rng::Stream(0, "check");
    for (const std::string& kind : GoalKindsOf(run.task.As<PickAndPlaceTaskConfig>())) {
      const auto same = [&](const SceneObject& object) { return object.name == kind; };
      if (std::ranges::none_of(contents, same)) contents.push_back(MakeGoalObject(kind, kind, rng));
    }
    return contents;
  }
};

}  // namespace

std::shared_ptr<const TaskKind> MakePickKind() { return std::make_shared<PickKind>(); }

std::shared_ptr<const TaskKind> MakePickAndPlaceKind() {
  return std::make_shared<PickAndPlaceKind>();
}

}  // namespace robocell
