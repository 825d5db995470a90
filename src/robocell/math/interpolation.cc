#include "robocell/math/interpolation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

void RequirePositive(double limit, std::string_view what) {
  if (!(limit > 0)) throw ArgumentError(fmt::format("{} must be > 0, not {}", what, limit));
}

void RequireSameSize(size_t size, size_t expected, std::string_view what) {
  if (size == expected) return;
  throw ArgumentError(fmt::format("{} has {}, but the start has {}", what,
                                  Counted(static_cast<int64_t>(size), "number"), expected));
}

}  // namespace

CoordinateState MinimumJerk(double time, double duration) {
  if (!(duration >= 0)) {
    throw ArgumentError(fmt::format("the duration of a motion must be >= 0 s, not {}", duration));
  }
  if (time >= duration) return {1, 0, 0};
  if (time <= 0) return {0, 0, 0};
  const double s = time / duration, rest = 1 - s;
  return {s * s * s * (10 + s * (-15 + 6 * s)), 30 * s * s * rest * rest / duration,
          60 * s * rest * (1 - 2 * s) / (duration * duration)};
}

// The largest velocity is 15/8 of the mean one, the largest acceleration 10 / sqrt(3) * distance /
// duration^2.
double MinimumJerkDuration(double distance, double max_velocity, double max_acceleration) {
  RequirePositive(max_velocity, "max_velocity");
  RequirePositive(max_acceleration, "max_acceleration");
  if (!std::isfinite(distance)) {
    throw ArgumentError(fmt::format("the distance of a motion must be finite, not {}", distance));
  }
  const double length = std::abs(distance);
  return std::max(1.875 * length / max_velocity,
                  std::sqrt(10 * std::numbers::inv_sqrt3 * length / max_acceleration));
}

TrapezoidalMotion::TrapezoidalMotion(double distance, double max_velocity, double max_acceleration)
    : distance_(distance), acceleration_(std::copysign(max_acceleration, distance)) {
  RequirePositive(max_velocity, "max_velocity");
  RequirePositive(max_acceleration, "max_acceleration");
  if (!std::isfinite(distance + max_velocity + max_acceleration)) {
    throw ArgumentError(fmt::format(
        "trapezoidal motion: distance {}, max_velocity {} and max_acceleration {} must be finite",
        distance, max_velocity, max_acceleration));
  }
  const double length = std::abs(distance);
  const double speed = std::min(max_velocity, std::sqrt(length * max_acceleration));
  ramp_ = speed / max_acceleration;
  cruise_end_ = speed > 0 ? length / speed : 0;
}

CoordinateState TrapezoidalMotion::at(double time) const {
  if (time <= 0) return {0, 0, 0};
  if (time >= duration()) return {distance_, 0, 0};
  if (time < ramp_) return {acceleration_ * time * time / 2, acceleration_ * time, acceleration_};
  if (time < cruise_end_) {
    const double speed = acceleration_ * ramp_;
    return {speed * (time - ramp_ / 2), speed, 0};
  }
  const double left = duration() - time;
  return {distance_ - acceleration_ * left * left / 2, acceleration_ * left, -acceleration_};
}

void InterpolateJoints(std::span<const double> from, std::span<const double> to, double s,
                       std::span<double> out) {
  RequireSameSize(to.size(), from.size(), "the goal");
  RequireSameSize(out.size(), from.size(), "out");
  for (size_t i = 0; i < from.size(); ++i) out[i] = (1 - s) * from[i] + s * to[i];
}

double JointMoveDuration(std::span<const double> from, std::span<const double> to,
                         std::span<const double> max_velocity,
                         std::span<const double> max_acceleration) {
  RequireSameSize(to.size(), from.size(), "the goal");
  RequireSameSize(max_velocity.size(), from.size(), "max_velocity");
  RequireSameSize(max_acceleration.size(), from.size(), "max_acceleration");
  double duration = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    duration = std::max(duration,
                        MinimumJerkDuration(to[i] - from[i], max_velocity[i], max_acceleration[i]));
  }
  return duration;
}

double PoseMoveDuration(const Pose& from, const Pose& to, const PoseMoveLimits& limits) {
  const double length = (to.translation() - from.translation()).norm();
  const double turn = AngleBetween(from.quaternion(), to.quaternion());
  return std::max(MinimumJerkDuration(length, limits.linear_velocity, limits.linear_acceleration),
                  MinimumJerkDuration(turn, limits.angular_velocity, limits.angular_acceleration));
}

}  // namespace robocell
