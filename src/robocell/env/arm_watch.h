// ArmWatch: how the joints of an arm move after they were sent somewhere, looked at after every
// engine step: whether they are slow, and whether they are at rest. It knows positions only.
//
//   ArmWatch watch(tolerances, timestep);
//   watch.Begin(q, time);                      // the arm was sent to `wanted`
//   watch.Look(q, wanted, time);               // after each engine step
//   if (watch.is_slow() && watch.IsNear(wanted)) ...
//
// Servos at their force limit may chatter: their force jumps from one limit to the other with every
// engine step, and the joint back and forth. So speeds, and ways in a window of time, are those of
// means over two steps. No allocation but in the constructor.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace robocell {

class ArmWatch {
 public:
  // `tolerances`: within which each joint has arrived, rad or m. `timestep`: the engine's, s.
  ArmWatch(std::vector<double> tolerances, double timestep);

  // The arm is at `q` and begins to move.
  void Begin(std::span<const double> q, double time);
  // The arm is at `q` now, an engine step later, and was sent to `wanted`.
  void Look(std::span<const double> q, std::span<const double> wanted, double time);

  const std::vector<double>& tolerances() const { return tolerances_; }
  // Where the joints were last seen.
  std::span<const double> pos() const { return seen_[0]; }
  bool IsNear(std::span<const double> wanted) const;
  // Joints are slow that would take kSettling to go as far as their tolerance.
  bool is_slow() const;
  // Whether the joints hardly moved in the last window of time, and do not get to `wanted` soon.
  bool at_rest() const { return at_rest_; }
  // Of a joint over the last two steps, per second; over fewer when there were not more, then 0.
  double Velocity(size_t joint) const;

 private:
  void StartWindow(double time);
  double Mean(size_t joint) const;
  bool HasHardlyMoved(std::span<const double> wanted, double window) const;

  std::vector<double> tolerances_;
  double timestep_;
  // Positions now, and one and two engine steps ago, as far as they were seen.
  std::array<std::vector<double>, 3> seen_;
  size_t steps_ = 0;
  std::vector<double> window_pos_;  // at the beginning of the window
  double window_since_ = 0;
  bool at_rest_ = false;
};

}  // namespace robocell
