#include "robocell/rollout/start_draw.h"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>

#include "robocell/base/call_hook.h"
#include "robocell/base/rng.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/randomization.h"

namespace robocell::internal {

namespace {

// Draws the values of `randomize:`, and puts them into the model of the start until it ends.
void Randomize(const RunConfig& run, const PlanItem& item, int attempt, EpisodeStart& start) {
  const auto randomization = std::make_shared<Randomization>(
      *run.randomize, start.scene.inner(),
      Randomization::Options{.place = "run '" + run.run + "'", .directory = run.source_dir});
  const Rng stream = run.randomize->every == RandomizeEvery::kScene
                         ? Rng::Stream(static_cast<uint64_t>(run.seed), "randomize", item.scene)
                         : AttemptStream(run, item, attempt, "randomize");
  start.randomized = randomization->Apply(stream, start.randomized);
  start.randomization = randomization;
}

}  // namespace

SampleResult DrawStart(const StartDraw& from, const PlanItem& item, int attempt,
                       const StopRequest& stop) {
  Rng rng = AttemptStream(from.run, item, attempt, "start");
  const auto sample = [&] {
    return from.sampler.Sample({item.scene, item.episode, attempt, stop, from.scene_data}, rng);
  };
  SampleResult drawn = from.is_users ? CallHook(from.sampler, "sample", sample) : sample();
  if (drawn.start && from.run.randomize) Randomize(from.run, item, attempt, *drawn.start);
  return drawn;
}

void RefusedStarts::Add(const Refusal& refusal) {
  ++total_;
  const int count = ++counts_[refusal.counted_as()];
  if (refusal.reason == Refusal::kNoReachableBasePose) ++out_of_reach_;
  if (count < most_) return;
  most_ = count;
  detail_ = refusal.detail;
}

std::string RefusedStarts::Text() const {
  std::string text;
  for (const auto& [reason, count] : counts_)
    text += fmt::format("{}{} {}", text.empty() ? ": " : ", ", reason, Counted(count, "time"));
  return text;
}

}  // namespace robocell::internal
