#include "robocell/task/task_kind.h"

#include <fmt/format.h>

#include <memory>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/navigate_kind.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/pick_kind.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/relation_kinds.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_calls.h"

namespace robocell {

KindRegistry& TaskKindRegistry() {
  static KindRegistry registry("task", "kind", PickTaskConfig::kKind, [] {
    KindRegistry::Kinds kinds = {
        {PickTaskConfig::kKind,
         {std::make_shared<KindFieldsOf<PickTaskConfig>>(), internal::MakePickKind()}},
        {PickAndPlaceTaskConfig::kKind,
         {std::make_shared<KindFieldsOf<PickAndPlaceTaskConfig>>(),
          internal::MakePickAndPlaceKind()}}};
    kinds[NavigateTaskConfig::kKind] = {std::make_shared<KindFieldsOf<NavigateTaskConfig>>(),
                                        internal::MakeNavigateKind()};
    internal::AddRelationKinds(kinds);
    return kinds;
  }());
  return registry;
}

std::shared_ptr<TaskSampler> TaskKind::MakeSampler(const RunConfig& run) const {
  return std::make_shared<StartSampler>(run);
}

std::vector<StartContents> TaskKind::PossibleContents(const RunConfig& run, int scene,
                                                      const SceneSpec& base,
                                                      const Task::KnownScene& known) const {
  constexpr size_t kLeastTurns = 16;  // for what is drawn at random
  const auto seed = static_cast<uint64_t>(run.seed);
  std::vector<StartContents> possible;
  std::set<std::vector<std::string>> seen;
  const auto longest = std::make_shared<size_t>(kLeastTurns);
  for (int episode = 0; static_cast<size_t>(episode) < *longest; ++episode) {
    SceneSpec spec = base;
    Rng rng = Rng::Stream(seed, "possible contents", scene, episode);
    StartContents contents = PrepareContents(
        *Make(run.task),
        {.known = known, .kind = run.task.kind(), .turn = {seed, scene, episode, longest}}, spec,
        rng);
    std::vector<std::string> names = contents.kinds;
    for (const SceneObject& object : contents.objects) names.push_back(object.name);
    if (seen.insert(names).second) possible.push_back(std::move(contents));
  }
  return possible;
}

std::vector<SceneObject> TaskKind::Contents(const RunConfig& run) const {
  const int scene = SceneIndices(run).front();
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  std::shared_ptr<const SceneAnnotations> annotations;
  const auto known = [&] {
    if (!annotations)
      annotations = std::make_shared<const SceneAnnotations>(source->Annotations(scene));
    return annotations;
  };
  return OneOfEachKind(PossibleContents(run, scene, MakeBaseScene(run, *source, scene), known));
}

void RegisterTask(const std::string& kind, std::shared_ptr<const KindFields> fields,
                  std::shared_ptr<const TaskKind> task, bool replace) {
  if (!task) throw ArgumentError("task '" + kind + "' needs a TaskKind that makes it");
  TaskKindRegistry().Register(kind, {std::move(fields), std::move(task)}, replace);
}

std::shared_ptr<const TaskKind> FindTaskKind(const std::string& kind) {
  const KindRegistry& registry = TaskKindRegistry();
  if (auto task = std::dynamic_pointer_cast<const TaskKind>(registry.RulesOf(kind))) return task;
  throw NotFoundError(fmt::format(
      "task '{}' is registered with its fields alone; register it with RegisterTask", kind));
}

std::shared_ptr<Task> MakeTask(const EnvConfig& config, const Scene& scene) {
  if (!config.task) return nullptr;
  std::shared_ptr<Task> task = FindTaskKind(config.task->kind())->Make(*config.task);
  TaskSetting setting{.place = "environment '" + config.name + "'",
                      .robots = internal::ArmsWithHands(scene, config.robots.keys())};
  for (const auto& [id, object] : config.root_frame_objects.entries())
    setting.objects.emplace(id, object->offset);
  internal::TaskCalls(*task).Bind(scene, setting);
  return task;
}

void PrepareTask(const EnvConfig& config, SceneSpec& spec) {
  if (!config.task) return;
  Rng rng = Rng::Stream(0, "env task contents", config.task->kind());
  const SceneSpec& so_far = spec;
  const auto known = [&] {
    return std::make_shared<const SceneAnnotations>(DeriveAnnotations(so_far));
  };
  const std::string& kind = config.task->kind();
  internal::TaskCalls(*FindTaskKind(kind)->Make(*config.task)).Prepare(known, spec, rng, kind);
}

}  // namespace robocell
