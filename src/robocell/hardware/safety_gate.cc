#include "robocell/hardware/safety_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr double kFirstShare = 0.1;    // of the speed, at the beginning of a slow start
constexpr double kClockDrift = 1e-3;   // s per s
constexpr double kJumpMargin = 0.05;   // rad or m: noise and rounding of a measurement
constexpr double kBeyond = 0.1;        // rad or m beyond a limit of position, where the arm stops
constexpr double kSpeedMargin = 0.05;  // rad/s or m/s: noise of measured speeds
constexpr double kRest = 1e-9;

// Returns the largest speed towards a limit at distance `d` from which the command can still brake
// with `a` in periods of `h`.
double BrakingSpeed(double d, double a, double h) {
  if (d <= 0) return 0;
  return std::max(std::sqrt(2 * a * d) - a * h / 2, std::min(d / h, a * h));
}

bool AllFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void RequirePositive(double value, const char* name, const std::string& place) {
  if (value > 0 && std::isfinite(value)) return;
  throw ArgumentError(
      fmt::format("{}: {} is {}; expected a finite value above 0", place, name, value));
}

void RequireNotNegative(double value, const char* name, const std::string& place) {
  if (value >= 0 && std::isfinite(value)) return;
  throw ArgumentError(
      fmt::format("{}: {} is {}; expected a finite value of at least 0", place, name, value));
}

}  // namespace

const char* ToString(ArmState state) {
  switch (state) {
    case ArmState::kWaiting:
      return "waiting";
    case ArmState::kRunning:
      return "running";
    case ArmState::kHolding:
      return "holding";
    case ArmState::kStopped:
      return "stopped";
  }
  return "?";
}

SafetyGate::SafetyGate(std::vector<std::string> joints, const ArmLimits& limits,
                       const SafetyOptions& options, double period, std::string place)
    : joints_(std::move(joints)), options_(options), period_(period), place_(std::move(place)) {
  RequireValid(limits, joints_, place_);
  limits_ = Narrowed(limits, options.limits, joints_, place_);
  RequirePositive(period, "period", place_);
  RequirePositive(options.speed, "speed", place_);
  if (options.speed > 1) {
    throw ArgumentError(
        fmt::format("{}: speed is {}; it is a share of the velocity limits, at "
                    "most 1",
                    place_, options.speed));
  }
  RequirePositive(options.watchdog, "watchdog", place_);
  RequirePositive(options.max_lead, "max_lead", place_);
  RequireNotNegative(options.slow_start, "slow_start", place_);
  RequireNotNegative(options.dead_man, "dead_man", place_);
  still_.resize(joints_.size());
}

bool SafetyGate::IsStale(const ArmMeasurement& measured, double now) const {
  if (counts_.accepted == 0) return false;
  if (!(measured.time > measured_.time)) return true;
  // A packet that waited in a queue, and clocks that jump or run at another speed.
  return std::abs(now - measured.time - offset_) > options_.watchdog;
}

bool SafetyGate::IsDamaged(const ArmMeasurement& measured) const {
  if (!std::isfinite(measured.time)) return true;
  for (const std::vector<double>* values : {&measured.pos, &measured.vel, &measured.force}) {
    if (values->size() != joints_.size() || !AllFinite(*values)) return true;
  }
  return false;
}

bool SafetyGate::IsJump(const ArmMeasurement& measured) const {
  if (counts_.accepted == 0) return false;
  const double seconds = measured.time - measured_.time;
  for (size_t i = 0; i < joints_.size(); ++i) {
    const double most = 2 * limits_.velocity[i] * seconds + kJumpMargin;
    if (std::abs(measured.pos[i] - measured_.pos[i]) > most) return true;
  }
  return false;
}

void SafetyGate::Begin(const ArmMeasurement& measured) {
  command_.pos = measured.pos;
  command_.vel.assign(joints_.size(), 0);
  lower_ = limits_.lower;
  upper_ = limits_.upper;
  for (size_t i = 0; i < joints_.size(); ++i) {
    lower_[i] = std::min(lower_[i], measured.pos[i]);
    upper_[i] = std::max(upper_[i], measured.pos[i]);
  }
  yield_.reserve(joints_.size());
  command_.force.reserve(joints_.size());
}

void SafetyGate::CheckPlace(const ArmMeasurement& measured) {
  const std::vector<double>& lower = began_ ? lower_ : limits_.lower;
  const std::vector<double>& upper = began_ ? upper_ : limits_.upper;
  for (size_t i = 0; i < joints_.size(); ++i) {
    const double p = measured.pos[i];
    if (p >= lower[i] - kBeyond && p <= upper[i] + kBeyond) continue;
    Stop(
        fmt::format("joint '{}' is at {:.3f}, outside its limits {:.3f} to {:.3f}; move it back "
                    "by hand",
                    joints_[i], p, limits_.lower[i], limits_.upper[i]));
  }
}

bool SafetyGate::Accept(const ArmMeasurement& measured, double now) {
  if (IsDamaged(measured)) {
    ++counts_.damaged;
    return false;
  }
  if (IsStale(measured, now)) {
    ++counts_.stale;
    return false;
  }
  if (IsJump(measured)) {
    ++counts_.damaged;
    return false;
  }
  CheckPlace(measured);
  if (!began_) Begin(measured);
  if (counts_.accepted == 0) {
    offset_ = now - measured.time;
  } else {
    const double drift = kClockDrift * (measured.time - measured_.time);
    offset_ = std::min(offset_ + drift, now - measured.time);
  }
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (counts_.accepted == 0 || measured.vel[i] != 0) still_[i] = measured.pos[i];
  }
  ++counts_.accepted;
  measured_ = measured;
  heard_ = now;
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (std::abs(measured.force[i]) <= limits_.force[i]) continue;
    if (state_ != ArmState::kStopped) yield_ = measured.pos;
    Stop(fmt::format("the force of joint '{}' is {:.1f}, beyond its limit of {:.1f}", joints_[i],
                     measured.force[i], limits_.force[i]));
    break;
  }
  return true;
}

void SafetyGate::Stop(const std::string& reason) {
  if (state_ == ArmState::kStopped) return;
  state_ = ArmState::kStopped;
  reason_ = fmt::format("{} stopped: {}", place_, reason);
}

void SafetyGate::Hold(const std::string& reason) {
  if (state_ == ArmState::kHolding) return;
  state_ = ArmState::kHolding;
  reason_ = reason;
}

void SafetyGate::CheckState(std::span<const double> wanted, double now) {
  if (state_ == ArmState::kStopped) return;
  if (now - heard_ > options_.watchdog) {
    Stop(fmt::format("no good measurement for {:.2f} s ({} were damaged, {} too old)", now - heard_,
                     counts_.damaged, counts_.stale));
    return;
  }
  if (wanted.size() != joints_.size()) {
    Stop(fmt::format("the controller commanded {} joints; the arm has {}", wanted.size(),
                     joints_.size()));
    return;
  }
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (std::isfinite(wanted[i])) continue;
    Stop(fmt::format("the controller commanded {} to joint '{}'", wanted[i], joints_[i]));
    return;
  }
  if (options_.dead_man > 0 && now - renewed_ > options_.dead_man) {
    Hold("the dead man's switch is released");
    return;
  }
  if (state_ == ArmState::kRunning) return;
  if (!is_at_rest()) return;
  state_ = ArmState::kRunning;
  reason_.clear();
  ticks_ = 0;
}

bool SafetyGate::is_at_rest() const {
  return std::all_of(command_.vel.begin(), command_.vel.end(),
                     [](double v) { return std::abs(v) < kRest; });
}

void SafetyGate::Move(size_t joint, double target, double share) {
  const double a = limits_.acceleration[joint], h = period_;
  const double p = command_.pos[joint], v = command_.vel[joint];
  const double goal = std::clamp(target, lower_[joint], upper_[joint]);
  const double most = limits_.velocity[joint] * options_.speed * share;
  const double distance = goal - p;
  // It brakes for the goal as for a limit, so that it does not swing about it.
  const double wish = std::copysign(
      std::min({most, std::abs(distance) / h, BrakingSpeed(std::abs(distance), a, h)}), distance);
  const double next = std::clamp(wish, v - a * h, v + a * h);
  // Rounding must not carry a command beyond its limit.
  const double place = std::clamp(p + next * h, lower_[joint], upper_[joint]);
  changed_ |= std::abs(place - target) > kRest;
  command_.vel[joint] = next;
  command_.pos[joint] = place;
}

double SafetyGate::TakeShare() {
  if (state_ != ArmState::kRunning) return 1;
  const double at = static_cast<double>(ticks_++) * period_;
  if (options_.slow_start == 0) return 1;
  return std::min(1.0, kFirstShare + (1 - kFirstShare) * at / options_.slow_start);
}

const ArmCommand* SafetyGate::Release(double opening) {
  const bool is_running = state_ == ArmState::kRunning;
  if (is_running && changed_) ++counts_.limited;
  const bool opens = is_running && std::isfinite(opening);
  command_.opening = opens ? std::clamp(opening, 0.0, 1.0) : kNoOpening;
  if (options_.dry_run) return nullptr;
  if (state_ == ArmState::kStopped && yield_.empty() && is_at_rest()) return nullptr;
  ++counts_.sent;
  return &command_;
}

const ArmCommand* SafetyGate::Next(std::span<const double> wanted, double opening, double now) {
  if (counts_.accepted == 0) return nullptr;
  began_ = true;
  CheckState(wanted, now);
  command_.force.clear();
  const bool is_running = state_ == ArmState::kRunning;
  const double share = TakeShare();
  changed_ = false;
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (is_running) {
      double target = wanted[i];
      if (!options_.dry_run) {
        const double at = measured_.pos[i];
        target = std::clamp(target, at - options_.max_lead, at + options_.max_lead);
      }
      Move(i, target, share);
      changed_ |= target != wanted[i];
    } else if (!yield_.empty()) {
      Move(i, yield_[i], kFirstShare);
    } else {
      const double v = command_.vel[i], dv = limits_.acceleration[i] * period_;
      command_.vel[i] = v - std::clamp(v, -dv, dv);
      command_.pos[i] =
          std::clamp(command_.pos[i] + command_.vel[i] * period_, lower_[i], upper_[i]);
    }
  }
  return Release(opening);
}

void SafetyGate::CheckMotion(double share) {
  for (size_t i = 0; i < joints_.size(); ++i) {
    const double p = measured_.pos[i], v = measured_.vel[i];
    if (!std::isfinite(limits_.force[i])) {
      Stop(fmt::format(
          "joint '{}' has no limit of force; give one in the limits of the arm's safety "
          "to command torques",
          joints_[i]));
      return;
    }
    if (options_.dry_run) continue;
    if (std::abs(p - still_[i]) > kJumpMargin) {
      Stop(
          fmt::format("joint '{}' moved by {:.2f} while its measured velocity was 0; an arm under "
                      "torques must measure its velocities",
                      joints_[i], std::abs(p - still_[i])));
      return;
    }
    const double most = limits_.velocity[i] * options_.speed * share + kSpeedMargin;
    if (std::abs(v) > most) {
      Stop(fmt::format("joint '{}' moves at {:.2f} under torques, beyond its limit of {:.2f}",
                       joints_[i], v, most));
      return;
    }
    const double distance = std::max(v > 0 ? upper_[i] - p : p - lower_[i], 0.0);
    const double slow = std::max(std::abs(v) - kSpeedMargin, 0.0);
    if (slow * slow > 2 * limits_.acceleration[i] * distance) {
      Stop(
          fmt::format("joint '{}' is at {:.3f} and moves at {:.2f} under torques; it can hardly "
                      "brake before its limit",
                      joints_[i], p, v));
      return;
    }
  }
}

const ArmCommand* SafetyGate::NextForces(std::span<const double> wanted, double opening,
                                         double now) {
  if (counts_.accepted == 0) return nullptr;
  CheckState(wanted, now);
  if (state_ == ArmState::kRunning) CheckMotion(TakeShare());
  if (state_ != ArmState::kRunning) return Next(wanted, opening, now);
  began_ = true;
  changed_ = false;
  command_.force.resize(joints_.size());
  for (size_t i = 0; i < joints_.size(); ++i) {
    // An arm that stops begins to brake here.
    command_.pos[i] = std::clamp(measured_.pos[i], lower_[i], upper_[i]);
    command_.vel[i] = std::clamp(measured_.vel[i], -limits_.velocity[i], limits_.velocity[i]);
    command_.force[i] = std::clamp(wanted[i], -limits_.force[i], limits_.force[i]);
    changed_ |= command_.force[i] != wanted[i];
  }
  return Release(opening);
}

}  // namespace robocell
