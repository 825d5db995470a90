// ArmWatch: observes how the joints of an arm move towards their targets, after every engine step:
// whether they are slow, and whether they are at rest. It knows positions only.
//
//   ArmWatch watch(tolerances, timestep);
//   watch.Begin(q, time);                      // the arm was sent to `wanted`
//   watch.Look(q, wanted, time);               // after each engine step
//   if (watch.is_slow() && watch.IsNear(wanted)) ...
//
// Servos at their force limit may chatter: their force jumps from one limit to the other with every
// engine step, and the joint back and forth. Speeds, and displacements in a window of time, are
// therefore those of means over two steps. Only the constructor allocates.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace robocell::internal {

class ArmWatch {
 public:
  // `tolerances`: a joint has arrived within its tolerance, rad or m. `timestep`: the engine's, s.
  // `delay`: after it a joint begins to move, s; until then it is not at rest.
  ArmWatch(std::vector<double> tolerances, double timestep, double delay = 0);

  // The arm is at `q` and begins to move.
  void Begin(std::span<const double> q, double time);
  // The arm is at `q` now, an engine step later, and `wanted` is its target.
  void Look(std::span<const double> q, std::span<const double> wanted, double time);

  const std::vector<double>& tolerances() const { return tolerances_; }
  // Returns the joints' last observed positions.
  std::span<const double> pos() const { return seen_[0]; }
  bool IsNear(std::span<const double> wanted) const;
  // Returns true if each joint would take kSettling to move by its tolerance.
  bool is_slow() const;
  // Returns true if the joints hardly moved in the last window of time, and do not get to `wanted`
  // soon.
  bool at_rest() const { return at_rest_; }
  // Returns a joint's velocity over the last two steps, per second; over one step if there was only
  // one, 0 before.
  double Velocity(size_t joint) const;

 private:
  void StartWindow(double time);
  double Mean(size_t joint) const;
  bool HasHardlyMoved(std::span<const double> wanted, double window) const;

  std::vector<double> tolerances_;
  double timestep_, delay_;
  double moves_from_ = 0;  // when the joints begin to move
  // Positions now, and one and two engine steps ago, as far as they were observed.
  std::array<std::vector<double>, 3> seen_;
  size_t steps_ = 0;
  // Positions at the start and the middle of the window.
  std::vector<double> window_pos_, middle_pos_;
  double window_since_ = 0;
  bool has_middle_ = false;
  bool at_rest_ = false;
};

}  // namespace robocell::internal
