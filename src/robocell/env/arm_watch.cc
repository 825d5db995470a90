#include "robocell/env/arm_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/robot/arrival.h"

namespace robocell::internal {
namespace {

// s. A joint at rest is so slow that it would take this long to move by its tolerance; also the
// window over which an arm away from its target is watched.
constexpr double kSettling = 0.1;
// The largest motion of a resting joint from the beginning of a window to its middle and its end: a
// share of its tolerance, or of the distance to its target. An arm that swings slowly may end a
// window where it began.
constexpr double kRestShare = 0.1, kRestShareOfDistance = 0.01;
// A joint that creeps to its target is moving as long as it gets within its tolerance in no more
// than this time, s.
constexpr double kPatience = 1;

}  // namespace

ArmWatch::ArmWatch(std::vector<double> tolerances, double timestep, double delay)
    : tolerances_(std::move(tolerances)),
      timestep_(timestep),
      delay_(delay),
      window_pos_(tolerances_.size()),
      middle_pos_(tolerances_.size()) {
  seen_.fill(window_pos_);
}

void ArmWatch::Begin(std::span<const double> q, double time) {
  std::ranges::copy(q, seen_[0].begin());
  steps_ = 0;
  at_rest_ = false;
  moves_from_ = time + delay_;
  StartWindow(time);
}

void ArmWatch::StartWindow(double time) {
  for (size_t i = 0; i < window_pos_.size(); ++i) window_pos_[i] = Mean(i);
  window_since_ = time;
  has_middle_ = false;
}

void ArmWatch::Look(std::span<const double> q, std::span<const double> wanted, double time) {
  std::rotate(seen_.begin(), seen_.end() - 1, seen_.end());
  std::ranges::copy(q, seen_[0].begin());
  ++steps_;
  if (time < moves_from_) {
    StartWindow(time);
    return;
  }
  const bool slow = is_slow();
  const double window = time - window_since_;
  if (slow && !has_middle_ && window >= kSettling / 2) {
    for (size_t i = 0; i < middle_pos_.size(); ++i) middle_pos_[i] = Mean(i);
    has_middle_ = true;
  }
  if (slow && window < kSettling) return;
  at_rest_ = slow && HasHardlyMoved(wanted, window);
  StartWindow(time);
}

bool ArmWatch::IsNear(std::span<const double> wanted) const {
  return AreWithin(seen_[0], wanted, tolerances_);
}

double ArmWatch::Velocity(size_t joint) const {
  const size_t ago = std::min<size_t>(steps_, 2);
  if (ago == 0) return 0;
  return (seen_[0][joint] - seen_[ago][joint]) / (static_cast<double>(ago) * timestep_);
}

double ArmWatch::Mean(size_t joint) const {
  return steps_ == 0 ? seen_[0][joint] : (seen_[0][joint] + seen_[1][joint]) / 2;
}

bool ArmWatch::is_slow() const {
  if (steps_ < 2) return false;
  for (size_t i = 0; i < tolerances_.size(); ++i) {
    if (std::abs(Velocity(i)) * kSettling > tolerances_[i]) return false;
  }
  return true;
}

// True if the joint moved in the window by little of its tolerance, or too little to cover the
// remaining distance soon.
bool ArmWatch::HasHardlyMoved(std::span<const double> wanted, double window) const {
  for (size_t i = 0; i < tolerances_.size(); ++i) {
    const double now = Mean(i), left = std::abs(now - wanted[i]);
    const double nearer = std::abs(window_pos_[i] - wanted[i]) - left,
                 beyond = left - tolerances_[i];
    if (beyond > 0 && nearer * kPatience > beyond * window) return false;
    const double most = std::max(kRestShare * tolerances_[i], kRestShareOfDistance * left);
    if (std::abs(now - window_pos_[i]) > most) return false;
    if (std::abs(middle_pos_[i] - window_pos_[i]) > most) return false;
  }
  return true;
}

}  // namespace robocell::internal
