#include "robocell/motion/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ruckig/ruckig.hpp>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr double kNoMotion = 1e-12;

double Limit(const std::vector<double>& values, size_t joint) {
  return values.size() == 1 ? values[0] : values[joint];
}

void RequireLimits(const char* name, const std::vector<double>& values, size_t joints) {
  if (values.size() != 1 && values.size() != joints) {
    throw ArgumentError(fmt::format("motion limits: {} has {} values, expected 1 or {}", name,
                                    values.size(), joints));
  }
  for (const double value : values) {
    if (value > 0 && std::isfinite(value)) continue;
    throw ArgumentError(
        fmt::format("motion limits: {} has {}; it must be above 0 and finite", name, value));
  }
}

void RequirePath(std::span<const std::vector<double>> path, const MotionLimits& limits) {
  if (path.empty()) throw ArgumentError("timing a path: it has no waypoints");
  const size_t joints = path[0].size();
  for (size_t k = 0; k < path.size(); ++k) {
    const bool is_finite =
        std::ranges::all_of(path[k], [](double value) { return std::isfinite(value); });
    if (path[k].size() != joints || !is_finite) {
      throw ArgumentError(
          fmt::format("timing a path: waypoint {} has {} values, expected {} that are finite", k,
                      path[k].size(), joints));
    }
  }
  RequireLimits("velocity", limits.velocity, joints);
  RequireLimits("acceleration", limits.acceleration, joints);
  RequireLimits("jerk", limits.jerk, joints);
}

// Limits of the share of a straight line, from 0 to 1.
struct SegmentLimits {
  double velocity = std::numeric_limits<double>::infinity();
  double acceleration = std::numeric_limits<double>::infinity();
  double jerk = std::numeric_limits<double>::infinity();
};

SegmentLimits LimitsOfSegment(std::span<const double> from, std::span<const double> to,
                              const MotionLimits& limits) {
  SegmentLimits segment;
  for (size_t i = 0; i < from.size(); ++i) {
    const double length = std::abs(to[i] - from[i]);
    if (length < kNoMotion) continue;
    segment.velocity = std::min(segment.velocity, Limit(limits.velocity, i) / length);
    segment.acceleration = std::min(segment.acceleration, Limit(limits.acceleration, i) / length);
    segment.jerk = std::min(segment.jerk, Limit(limits.jerk, i) / length);
  }
  return segment;
}

}  // namespace

int Trajectory::n_joints() const {
  return points_.empty() ? 0 : static_cast<int>(points_[0].size());
}

Trajectory TimePath(std::span<const std::vector<double>> path, const MotionLimits& limits) {
  RequirePath(path, limits);
  Trajectory motion;
  motion.points_.push_back(path[0]);
  motion.starts_.push_back(0);
  ruckig::Ruckig<1> generator;
  for (size_t k = 1; k < path.size(); ++k) {
    const SegmentLimits segment = LimitsOfSegment(path[k - 1], path[k], limits);
    if (!std::isfinite(segment.velocity)) continue;  // the same configuration again
    // In the line's own unit of time, in which its largest speed is 1: numbers near 1 solve best.
    const double second = segment.velocity;
    ruckig::InputParameter<1> input;
    input.current_position = {0};
    input.target_position = {1};
    input.max_velocity = {1};
    input.max_acceleration = {segment.acceleration / (second * second)};
    input.max_jerk = {segment.jerk / (second * second * second)};
    ruckig::Trajectory<1> solved;
    if (generator.calculate(input, solved) != ruckig::Result::Working) {
      throw Error(
          fmt::format("timing a path: no motion to waypoint {} within the limits; they may "
                      "be many powers of ten apart",
                      k));
    }
    Trajectory::Line line;
    const ruckig::Profile profile = solved.get_profiles()[0][0];
    double start = 0;
    for (size_t phase = 0; phase < profile.t.size(); ++phase) {
      if (profile.t[phase] <= 0) continue;
      line.phases.push_back({start / second, profile.p[phase], profile.v[phase] * second,
                             profile.a[phase] * second * second,
                             profile.j[phase] * second * second * second});
      start += profile.t[phase];
    }
    motion.lines_.push_back(std::move(line));
    motion.points_.push_back(path[k]);
    motion.starts_.push_back(motion.starts_.back() + solved.get_duration() / second);
  }
  return motion;
}

TrajectoryPoint Trajectory::At(double time) const {
  const size_t n = n_joints();
  TrajectoryPoint point{.velocity = std::vector<double>(n), .acceleration = std::vector<double>(n)};
  if (points_.empty()) return point;
  if (!(time > 0) || lines_.empty()) return point.position = points_.front(), point;
  if (time >= duration()) return point.position = points_.back(), point;
  const size_t line = std::ranges::upper_bound(starts_, time) - starts_.begin() - 1;
  const double within = time - starts_[line];
  const std::vector<Phase>& phases = lines_[line].phases;
  const auto after = std::ranges::upper_bound(phases, within, {}, &Phase::start);
  const Phase& p = after == phases.begin() ? phases.front() : *(after - 1);
  const double t = within - p.start;
  const double share = p.share + t * (p.speed + t * (p.acceleration / 2 + t * p.jerk / 6));
  const double speed = p.speed + t * (p.acceleration + t * p.jerk / 2);
  const double acceleration = p.acceleration + t * p.jerk;
  point.position.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const double length = points_[line + 1][i] - points_[line][i];
    point.position[i] = points_[line][i] + std::clamp(share, 0.0, 1.0) * length;
    point.velocity[i] = speed * length;
    point.acceleration[i] = acceleration * length;
  }
  return point;
}

std::vector<std::vector<double>> Trajectory::Sample(double tick) const {
  if (!(tick > 0 && std::isfinite(tick)))
    throw ArgumentError(
        fmt::format("sampling a trajectory: the tick is {} s; it must be above 0", tick));
  std::vector<std::vector<double>> rows;
  const auto ticks = static_cast<int64_t>(std::ceil(duration() / tick - 1e-9));
  for (int64_t k = 0; k < ticks; ++k) rows.push_back(At(static_cast<double>(k) * tick).position);
  if (!points_.empty()) rows.push_back(points_.back());
  return rows;
}

std::string WhyTooSlow(std::span<const std::vector<double>> path, const MotionLimits& limits,
                       double seconds, std::span<const std::string> joint_names) {
  const double needed = TimePath(path, limits).duration();
  if (needed <= seconds) return "";
  size_t slowest = 0;
  double most = 0;
  for (size_t i = 0; i < path[0].size(); ++i) {
    std::vector<std::vector<double>> alone;  // the motion of this joint only
    for (const std::vector<double>& q : path) {
      alone.push_back(path[0]);
      alone.back()[i] = q[i];
    }
    const double time = TimePath(alone, limits).duration();
    if (time > most) most = time, slowest = i;
  }
  return fmt::format(
      "limits too tight: the path takes {:.3g} s, more than {:.3g} s; joint '{}' alone takes "
      "{:.3g} s "
      "(velocity {:.3g}, acceleration {:.3g}, jerk {:.3g})",
      needed, seconds,
      slowest < joint_names.size() ? joint_names[slowest] : std::to_string(slowest), most,
      Limit(limits.velocity, slowest), Limit(limits.acceleration, slowest),
      Limit(limits.jerk, slowest));
}

}  // namespace robocell
