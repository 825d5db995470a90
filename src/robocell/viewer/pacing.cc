#include "robocell/viewer/pacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

constexpr double kMostBehind = 0.1;       // seconds; further behind it starts again
constexpr double kMomentApart = 1. / 32;  // seconds between the moments that are kept

}  // namespace

void Pacing::set_factor(double factor) {
  if (!std::isfinite(factor) || factor < 0) {
    throw ArgumentError(fmt::format(
        "realtime_factor: expected 0 (as fast as possible) or a number above it, such as 1 for "
        "real time; got {}",
        factor));
  }
  factor_ = factor;
  Restart();
}

double Pacing::Wait(double simulated, double wall) {
  if (!started_ || simulated < last_) {
    started_ = true;
    count_ = 0;
    origin_ = {simulated, wall};
  }
  last_ = simulated;
  Note(simulated, wall);
  if (factor_ == 0) return 0;
  const double due = origin_.wall + (simulated - origin_.simulated) / factor_;
  if (wall - due > kMostBehind) origin_ = {simulated, wall};
  return std::max(0., due - wall);
}

void Pacing::Note(double simulated, double wall) {
  if (count_ > 0 && wall - moments_[(count_ - 1) % moments_.size()].wall < kMomentApart) return;
  moments_[count_ % moments_.size()] = {simulated, wall};
  ++count_;
}

double Pacing::measured() const {
  if (count_ < 2) return 0;
  const size_t first = count_ > moments_.size() ? count_ - moments_.size() : 0;
  const Moment& from = moments_[first % moments_.size()];
  const Moment& to = moments_[(count_ - 1) % moments_.size()];
  return to.wall > from.wall ? (to.simulated - from.simulated) / (to.wall - from.wall) : 0;
}

void Pacing::Drew(double begin, double end, double pictures_per_s) {
  next_picture_ = std::max(begin + 1 / pictures_per_s, end + (end - begin));
}

}  // namespace robocell::internal
