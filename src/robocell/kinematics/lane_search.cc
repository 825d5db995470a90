#include "robocell/kinematics/lane_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "robocell/kinematics/lane_starts.h"

namespace robocell {
namespace {

// Steps that a seed is given before others join it.
constexpr int kStepsAlone = 8;

class LaneSearch {
 public:
  LaneSearch(const Chain& chain, const Transform& target, const IkOptions& options)
      : work_(chain, options),
        target_(target),
        starts_(work_, target, options.seed),
        starts_left_(1 + int64_t{work_.RestartsFor(target)}) {}

  IkResult Run() {
    Begin(0);
    if (work_.options().seed.empty()) Join();
    while (busy_ != 0 && !Step()) {
      if (steps_ == kStepsAlone) Join();
    }
    if (!answer_.success) answer_ = work_.Judge(target_, Best());
    answer_.iterations = steps_ - 1;  // the last one only measured
    answer_.restarts = answer_.success ? winner_ : starts_.begun() - 1;
    return answer_;
  }

 private:
  // Starts in all lanes that have none. One group of lanes costs as much as one lane.
  void Join() {
    joined_ = true;
    for (int lane = 0, count = GroupOfLanes(); lane < count; ++lane) {
      if ((busy_ >> lane & 1) == 0) Begin(lane);
    }
  }

  void Begin(int lane) {
    busy_ &= ~(1U << lane);
    if (starts_left_ == 0) return;
    --starts_left_;
    busy_ |= 1U << lane;
    if (!aimed_[lane]) work_.Aim(lane, target_);
    aimed_[lane] = true;
    age_[lane] = 0;
    number_[lane] = starts_.begun();
    starts_.Begin(lane, &work_);
  }

  // Whether an answer was found.
  bool Step() {
    ++steps_;
    const uint32_t arrived = work_.Step(busy_);
    for (uint32_t left = arrived; left != 0; left &= left - 1) TryAnswer(std::countr_zero(left));
    if (answer_.success) return true;
    for (uint32_t left = busy_; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const bool failed = (arrived >> lane & 1) != 0;
      if (!failed && !work_.IsHopeless(lane, number_[lane], ++age_[lane])) continue;
      joined_ ? Begin(lane) : Join(lane);
    }
    return false;
  }

  // The seed has failed before the others joined.
  void Join(int lane) {
    Begin(lane);
    Join();
  }

  void TryAnswer(int lane) {
    if (answer_.success && number_[lane] > winner_) return;
    const IkResult found = work_.Judge(target_, work_.Now(lane, starts_.seed()));
    if (!found.success) return;
    answer_ = found;
    winner_ = number_[lane];
  }

  JointVector Best() const {
    int best = 0;
    for (int lane = 1; lane < kMaxLanes; ++lane) {
      if (aimed_[lane] && work_.best_cost(lane) < work_.best_cost(best)) best = lane;
    }
    return work_.Best(best, starts_.seed());
  }

  LaneWork work_;
  const Transform& target_;
  LaneStarts starts_;
  int64_t starts_left_;
  int steps_ = 0;
  bool joined_ = false;
  uint32_t busy_ = 0;
  std::array<bool, kMaxLanes> aimed_{};
  std::array<int, kMaxLanes> age_{}, number_{};
  IkResult answer_;
  int winner_ = 0;
};

}  // namespace

IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options) {
  return LaneSearch(chain, tip_in_base, options).Run();
}

}  // namespace robocell
