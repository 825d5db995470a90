#include "robocell/task/sampler_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/registry.h"
#include "robocell/base/suggestions.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

using SamplerRegistry = Registry<std::shared_ptr<const SamplerKind>>;

SamplerRegistry& RegisteredSamplers() {
  static SamplerRegistry registry("sampler");
  return registry;
}

}  // namespace

void RegisterSampler(const std::string& kind, std::shared_ptr<const SamplerKind> sampler,
                     bool replace) {
  if (!sampler) throw ArgumentError("sampler '" + kind + "' needs a SamplerKind that makes it");
  RegisteredSamplers().Register(kind, std::move(sampler), replace);
}

std::vector<std::string> SamplerKinds() { return RegisteredSamplers().names(); }

std::shared_ptr<const SamplerKind> FindSamplerKind(const std::string& kind) {
  if (const auto sampler = RegisteredSamplers().Get(kind)) return *sampler;
  const std::vector<std::string> known = SamplerKinds();
  const std::string which = known.empty()
                                ? fmt::format("no sampler '{}': none is registered.", kind)
                                : NoSuchName("", "sampler", kind, known);
  throw NotFoundError(which +
                      " A sampler of your own is registered before: import its module, or name it "
                      "with --import. Without `sampler` the task's own is used");
}

std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run) {
  if (run.sampler.empty()) return FindTaskKind(run.task.kind())->MakeSampler(run);
  return FindSamplerKind(run.sampler)->Make(run);
}

namespace {

// Rows are timed by the run's rates, whatever made the scene.
void RequireTimestep(const Scene& scene, const RunConfig& run) {
  const double own = scene.timestep();
  if (run.rates.HasTimestep(own)) return;
  throw HookError(
      fmt::format("run '{}': scene '{}' was built with a timestep of {} s, and `rates` has one of "
                  "{} s; set SceneSpec.timestep to that of the run, or `rates: {{sim_ms: {:g}}}`",
                  run.run, scene.name(), own, run.rates.timestep().value(), own * 1000),
      "");
}

}  // namespace

void BindStart(EpisodeStart& start, const RunConfig& run) {
  RequireTimestep(start.scene, run);
  if (start.is_bound) return;
  TaskSetting setting{.place = "run '" + run.run + "'", .robots = {}, .is_run = true};
  for (const Robot& robot : RobotsOf(start.scene)) {
    if (robot.has_arm()) setting.robots.push_back(robot.name());
  }
  const std::string& own = run.robot.config.name;
  const bool has_own = std::ranges::find(setting.robots, own) != setting.robots.end();
  setting.robots = has_own ? internal::ArmsOfRun(run, start.scene)
                           : internal::ArmsWithHands(start.scene, setting.robots);
  internal::TaskCalls(*start.task).Bind(start.scene, setting);
  start.is_bound = true;
}

}  // namespace robocell
