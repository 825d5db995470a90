#include "robocell/task/pick_kind.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/names.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/pick_sampler.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/reach_advice.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

class PickKind final : public TaskKindOf<PickTaskConfig, PickTask> {
 public:
  std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) const override {
    return std::make_shared<PickTaskSampler>(run);
  }
  std::string expert() const override { return "pick"; }

  void CheckFields(const RunConfig& run, Problems& problems) const override {
    const std::vector<std::string> known = ObjectKinds();
    const NameList& chosen = run.task.As<PickTaskConfig>().objects;
    Problems::Scope objects(problems, "task.objects");
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (std::ranges::find(known, chosen[i]) != known.end()) continue;
      Problems::Scope item(problems, i);
      problems.Add(NoSuchName("task", "kind", chosen[i], known));
    }
  }
  // One of each kind that may be drawn, called as its kind.
  std::vector<SceneObject> Contents(const RunConfig& run) const override {
    const NameList& chosen = run.task.As<PickTaskConfig>().objects;
    Rng rng = Rng::Stream(0, "check");
    std::vector<SceneObject> objects;
    for (const std::string& kind : chosen.empty() ? ObjectKinds() : chosen.names)
      objects.push_back(MakeCatalogueObject(kind, kind, rng));
    return objects;
  }
  std::string ReachAdvice(const RunConfig& run) const override {
    return robocell::ReachAdvice(run);
  }
};

}  // namespace

std::shared_ptr<const TaskKind> MakePickKind() { return std::make_shared<PickKind>(); }

}  // namespace robocell
