#include "robocell/kinematics/lane_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/lane_starts.h"

namespace robocell::internal {
namespace {

// If the seed is farther from the target than this (squared error), or has not arrived after so
// many steps, other starts join it.
constexpr double kNearSeed = 0.25;
constexpr int kStepsAlone = 8;

class LaneSearch {
 public:
  LaneSearch(const Chain& chain, const Transform& target, const IkOptions& options,
             const std::function<void()>& poll)
      : work_(chain, options),
        target_(target),
        poll_(poll),
        starts_(work_, target, options.seed),
        seed_searches_(!options.seed.empty()) {}

  IkResult Run() {
    Begin(0);
    if (!seed_searches_) Join();
    Search();
    if (!answer_.success) GoOnWhereNear();
    if (answer_.success) {
      answer_.restarts = winner_;
    } else {
      answer_ = work_.Judge(target_, work_.Best(BestLane(), starts_.seed()));
      answer_.restarts = starts_.begun() - 1;
    }
    answer_.iterations = steps_ - (only_measured_ ? 1 : 0);
    return answer_;
  }

 private:
  void Search() {
    while (busy_ != 0 && !Step()) {
      if (!joined_ && (steps_ == kStepsAlone || work_.cost(0) > kNearSeed)) Join();
    }
  }

  // All starts have failed.
  void GoOnWhereNear() {
    starts_left_ = work_.MoreRestartsFor(target_, work_.best_cost(BestLane()));
    for (int lane = 0; lane < LanesOfOneQuestion(); ++lane) Begin(lane);
    Search();
  }

  // Starts in all lanes that have none. All cost as much as two.
  void Join() {
    joined_ = true;
    starts_left_ += work_.RestartsFor(target_);
    const int count = LanesOfOneQuestion();
    work_.Clear(1, count);
    if (starts_left_ > 0) starts_.Foresee(count, work_);
    for (int lane = 0; lane < count; ++lane) {
      if ((busy_ >> lane & 1) == 0) Begin(lane);
    }
  }

  void Begin(int lane) {
    busy_ &= ~(1U << lane);
    if (starts_left_ == 0) return;
    --starts_left_;
    busy_ |= 1U << lane;
    if (!IsAimed(lane)) work_.Aim(lane, target_);
    aimed_ |= 1U << lane;
    tried_ &= ~(1U << lane);
    age_[lane] = 0;
    number_[lane] = starts_.begun();
    starts_.Begin(lane, &work_);
  }

  // Returns true if a solution was found that no other can replace.
  bool Step() {
    ++steps_;
    const uint32_t arrived = work_.Step(busy_);
    for (uint32_t left = busy_; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const bool there = (arrived >> lane & 1) != 0;
      if (there || IsWorthATry(lane)) TryAnswer(lane, there);
    }
    if (answer_.success && winner_ == 0) return true;
    for (uint32_t left = busy_; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const bool failed = (arrived >> lane & 1) != 0;
      if (failed || work_.IsHopeless(lane, number_[lane], ++age_[lane])) GiveUp(lane);
    }
    if (!answer_.success) return false;
    busy_ &= 1U;  // where the seed's search goes on, which has the last word
    return !seed_searches_;
  }

  bool IsAimed(int lane) const { return (aimed_ >> lane & 1) != 0; }

  // Returns true if the lane has most likely arrived with this step, so that it is judged at once.
  bool IsWorthATry(int lane) const {
    return (tried_ >> lane & 1) == 0 && age_[lane] < work_.options().max_iterations &&
           work_.IsLikelyThere(lane);
  }

  void TryAnswer(int lane, bool only_measured) {
    tried_ |= 1U << lane;
    if (answer_.success && number_[lane] > winner_) return;
    const IkResult found = work_.Judge(target_, work_.Now(lane, starts_.seed()));
    if (!found.success) return;
    answer_ = found;
    winner_ = number_[lane];
    only_measured_ = only_measured;
  }

  void GiveUp(int lane) {
    if (number_[lane] == 0) seed_searches_ = false;
    if (answer_.success) return;
    if (poll_ && starts_.begun() % static_cast<int>(kPollEvery) == 0) poll_();
    if (joined_) return Begin(lane);
    busy_ = 0;
    Join();
  }

  int BestLane() const {
    int best = 0;
    for (int lane = 1; lane < kMaxLanes; ++lane) {
      if (IsAimed(lane) && work_.best_cost(lane) < work_.best_cost(best)) best = lane;
    }
    return best;
  }

  LaneWork work_;
  const Transform& target_;
  const std::function<void()>& poll_;
  LaneStarts starts_;
  int64_t starts_left_ = 1;  // until others join
  int steps_ = 0;
  bool seed_searches_;  // has not been given up
  bool joined_ = false;
  uint32_t busy_ = 0, aimed_ = 0, tried_ = 0;  // bits of lanes
  std::array<int, kMaxLanes> age_, number_;    // of busy lanes
  IkResult answer_;
  int winner_ = 0;
  bool only_measured_ = true;  // the last step that the answer took
};

}  // namespace

IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options,
                       const std::function<void()>& poll) {
  return LaneSearch(chain, tip_in_base, options, poll).Run();
}

}  // namespace robocell::internal
