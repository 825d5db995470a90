// The rates of engine steps, controllers and actions (one recorded row each), as times in ms or as
// rates in Hz. All are whole multiples of the engine's step, so that rows, videos and times agree
// exactly however long an episode is.
//
//   rates: {policy_ms: 66}                  # the defaults: 2 ms steps, 500/33 rows per second
//   rates: {sim_hz: 480, policy_hz: 30}     # exactly 30 rows and frames per second
#pragma once

#include <optional>

#include "robocell/base/ratio.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

struct Rates {
  std::optional<double> policy_ms = {};
  std::optional<double> policy_hz = {};
  std::optional<double> control_ms = {};
  std::optional<double> control_hz = {};
  std::optional<double> sim_ms = {};
  std::optional<double> sim_hz = {};
  int max_steps = 500;

  static constexpr const char* kTypeName = "Rates";
  template <class V>
  static void Fields(V&& v) {
    v("policy_ms", &Rates::policy_ms,
      "Time per action and recorded row, ms. Unset without policy_hz: 66.", Bound::kPositive);
    v("policy_hz", &Rates::policy_hz,
      "Actions and rows per second, instead of policy_ms: 30, or in YAML a fraction such as "
      "500/33.",
      Bound::kPositive);
    v("control_ms", &Rates::control_ms,
      "Time between two updates of the controllers, ms. Unset without control_hz: 2, or the "
      "engine's timestep if that does not divide 2 ms.",
      Bound::kPositive);
    v("control_hz", &Rates::control_hz,
      "Updates of the controllers per second, instead of control_ms.", Bound::kPositive);
    v("sim_ms", &Rates::sim_ms, "The engine's timestep, ms. Unset without sim_hz: 2.",
      Bound::kPositive);
    v("sim_hz", &Rates::sim_hz,
      "Steps of the engine per second, instead of sim_ms: 480 for a timestep of 1/480 s.",
      Bound::kPositive);
    v("max_steps", &Rates::max_steps, "Largest number of actions in an episode.", Bound::kPositive);
  }
  // Return whole numbers of control ticks per action and of engine steps per control tick; 0 where
  // a time is not a multiple of the next shorter one.
  int control_ticks() const;
  int sim_steps() const;
  // Return exact values: the engine's timestep in seconds, and actions per second. These and the
  // functions below throw ArgumentError for rates that are not whole multiples of each other.
  Ratio timestep() const;
  // Returns true if the timestep of a scene, in seconds, is this one.
  bool HasTimestep(double of_scene) const;
  Ratio policy_rate() const;
  // Return seconds per action and per control tick.
  double policy_period() const;
  double control_period() const;
  void Validate(Problems& problems) const;
};

}  // namespace robocell
