#include "robocell/rollout/start_draw.h"

#include <fmt/format.h>

#include <string>

#include "robocell/base/call_hook.h"
#include "robocell/base/rng.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {

SampleResult DrawStart(const StartDraw& from, const PlanItem& item, int attempt,
                       const StopRequest& stop) {
  Rng rng = AttemptStream(from.run, item, attempt, "start");
  const auto sample = [&] {
    return from.sampler.Sample({item.scene, item.episode, attempt, stop, from.scene_data}, rng);
  };
  return from.is_users ? CallHook(from.sampler, "sample", sample) : sample();
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
