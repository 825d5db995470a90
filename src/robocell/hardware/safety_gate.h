// SafetyGate: what stands between a controller and a port. It checks each measurement, and turns
// what a controller wants into what may be sent: within the limits of position, velocity and
// acceleration, in every tick, whatever is wanted.
//
//   SafetyGate gate(port.joint_names(), port.limits(), {.watchdog = 0.2}, 0.002);
//   if (port.Read(measured)) gate.Accept(measured, port.now());
//   if (const ArmCommand* command = gate.Next(wanted, opening, port.now())) port.Send(*command);
//
// It counts ticks, not seconds: a late tick moves the arm no farther than one in time. Commands
// begin where the arm was measured before the first tick, at rest. The braking distance is kept to every limit:
// with v the speed, a the acceleration and h the period, (v + a h / 2)^2 <= 2 a d.
//
// It stops for good, braking within the limits, when
// - nothing good was measured for `watchdog`: silence, damaged or repeated packets, old clocks;
// - a measured force is beyond its limit, or a measured position far beyond its own;
// - a command is not finite.
// While the dead man's switch is released, the arm brakes and holds; it starts slowly again.
//
// No allocation after the first measurement. Threads: one at a time.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "robocell/hardware/arm_port.h"

namespace robocell {

struct SafetyOptions {
  ArmLimits limits = {};  // narrower than those of the port; an empty list: the port's
  double speed = 1;       // share of the velocity limits that is used, above 0 to 1
  double watchdog = 0.2;  // longest time without a good measurement, s
  double slow_start = 2;  // time until full speed, s; it begins at a tenth
  double dead_man = 0;    // longest time between two calls of Renew(), s; 0: no switch
  double max_lead = 0.2;  // the command's largest distance from the measured joints, rad or m
  bool dry_run = false;   // compute everything, send nothing
};

enum class ArmState { kWaiting, kRunning, kHolding, kStopped };
const char* ToString(ArmState state);  // "waiting", ...

struct SafetyCounts {
  int64_t accepted = 0;  // measurements
  int64_t stale = 0;     // measurements that repeated or went back in time, or came too late
  int64_t damaged = 0;   // measurements with wrong sizes, values that are not finite, or jumps
  int64_t sent = 0;      // commands
  int64_t limited = 0;   // ticks in which a limit changed the command
};

class SafetyGate {
 public:
  // `period`: seconds between two calls of Next. Throws ArgumentError for invalid limits and options.
  SafetyGate(std::vector<std::string> joints, const ArmLimits& limits, const SafetyOptions& options,
             double period, std::string place = "arm");

  // Checks a measurement that was received at `now`. Returns false for one that does not count.
  bool Accept(const ArmMeasurement& measured, double now);
  // The dead man's switch is pressed.
  void Renew(double now) { renewed_ = now; }
  // Returns the command for one tick; null if nothing may be sent.
  const ArmCommand* Next(std::span<const double> wanted, double opening, double now);
  // The same for forces that a controller wants. They are kept within their limits; a joint that
  // moves faster than it may, or can no longer brake before a limit, stops the arm, which then
  // brakes by positions. So does one that moves without a measured velocity. With `dry_run` only
  // the forces are checked: someone else moves the arm.
  const ArmCommand* NextForces(std::span<const double> wanted, double opening, double now);
  // Stops for good. The first reason counts.
  void Stop(const std::string& reason);

  ArmState state() const { return state_; }
  // Returns why it holds or stopped; "" otherwise.
  const std::string& reason() const { return reason_; }
  // Returns true once the command is at rest.
  bool is_at_rest() const;
  const SafetyCounts& counts() const { return counts_; }
  const ArmMeasurement& measured() const { return measured_; }
  const ArmCommand& command() const { return command_; }
  const ArmLimits& limits() const { return limits_; }

 private:
  bool IsStale(const ArmMeasurement& measured, double now) const;
  bool IsDamaged(const ArmMeasurement& measured) const;
  // True for a place that no joint of this speed reaches in the time between.
  bool IsJump(const ArmMeasurement& measured) const;
  // Stops for a position far beyond its limits.
  void CheckPlace(const ArmMeasurement& measured);
  // Lets the commands begin there.
  void Begin(const ArmMeasurement& measured);
  void CheckState(std::span<const double> wanted, double now);
  // Stops an arm that forces carry beyond its limits; `share` of the speed is allowed.
  void CheckMotion(double share);
  // Returns the share of the speed that is used in this tick of a running arm.
  double TakeShare();
  // Returns the command, null if nothing may be sent.
  const ArmCommand* Release(double opening);
  void Hold(const std::string& reason);
  // Moves the command of a joint towards `target` by one tick.
  void Move(size_t joint, double target, double share);

  std::vector<std::string> joints_;
  ArmLimits limits_;
  SafetyOptions options_;
  double period_;
  std::string place_;

  ArmState state_ = ArmState::kWaiting;
  std::string reason_;
  SafetyCounts counts_;
  ArmMeasurement measured_;
  ArmCommand command_;
  std::vector<double> lower_, upper_;  // those of limits_, wide enough for where the arm began
  std::vector<double> yield_;          // positions to go to after a force; else empty
  std::vector<double> still_;          // positions since which the measured velocities are 0
  double heard_ = 0, renewed_ = -std::numeric_limits<double>::infinity();
  double offset_ = 0;   // smallest difference of both clocks
  int64_t ticks_ = 0;   // since the arm began to run
  bool began_ = false;  // Next was called
  bool changed_ = false;
};

}  // namespace robocell
