#include "robocell/rollout/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "robocell/base/error.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/yaml.h"

namespace robocell {

namespace {

// Stands for the path of the source dataset, whose content counts (run_inputs.h).
constexpr const char* kSourceInIdentity = "source";
// Far more than any real run: a typing error must not exhaust the memory.
constexpr int64_t kMostEpisodes = 10'000'000;

int TotalEpisodes(const RunConfig& run, size_t scenes) {
  const int64_t total =
      run.episodes ? *run.episodes : static_cast<int64_t>(scenes) * run.episodes_per_scene;
  if (total <= kMostEpisodes) return static_cast<int>(total);
  const std::string from = run.episodes ? "episodes"
                                        : fmt::format("{} scenes with episodes_per_scene: {}",
                                                      scenes, run.episodes_per_scene);
  throw SpecError(fmt::format("run '{}': {} makes {} episodes; {} is the most in one dataset",
                              run.run, from, total, kMostEpisodes));
}

}  // namespace

std::vector<PlanItem> MakePlan(const RunConfig& run) {
  std::vector<PlanItem> plan;
  const std::vector<int> scenes = SceneIndices(run);
  const int total = TotalEpisodes(run, scenes.size());
  for (int i = 0; i < total; ++i) {
    const int scene = scenes[i % scenes.size()];
    const int episode = i / static_cast<int>(scenes.size());
    plan.push_back({i, scene, episode, fmt::format("s{:04}_e{:04}", scene, episode)});
  }
  return plan;
}

std::vector<PlanItem> Shard(const std::vector<PlanItem>& plan, int shard, int count) {
  if (count < 1 || shard < 0 || shard >= count) {
    throw ArgumentError(fmt::format("shard {}/{} does not exist; shards of {} are 0/{} to {}/{}",
                                    shard, count, std::max(count, 1), std::max(count, 1),
                                    std::max(count, 1) - 1, std::max(count, 1)));
  }
  std::vector<PlanItem> items;
  for (const PlanItem& item : plan) {
    if (item.index % count == shard) items.push_back(item);
  }
  return items;
}

ShardSpec ParseShard(const std::string& text) {
  ShardSpec spec;
  const char* end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, spec.shard);
  if (first == std::errc() && slash != end && *slash == '/') {
    const auto [rest, second] = std::from_chars(slash + 1, end, spec.count);
    if (second == std::errc() && rest == end && spec.count > 0 && spec.shard >= 0 &&
        spec.shard < spec.count)
      return spec;
  }
  throw ArgumentError("'" + text + "' is not a shard: write i/N with 0 <= i < N, for example 0/8");
}

Rng AttemptStream(const RunConfig& run, const PlanItem& item, int attempt,
                  const std::string& purpose) {
  return Rng::Stream(static_cast<uint64_t>(run.seed), "scene", item.scene, "episode", item.episode,
                     "attempt", attempt, purpose);
}

std::string RunIdentity(const RunConfig& run) {
  RunConfig identity = run;
  identity.workers = 1;
  identity.render.reset();
  identity.output = "";
  identity.episodes.reset();
  identity.episodes_per_scene = 1;
  identity.scenes.houses = {};
  if (identity.augment) identity.augment->dataset = kSourceInIdentity;
  identity.imports = {};  // the contents of the modules count (run_inputs.h)
  return ToYaml(identity);
}

}  // namespace robocell
