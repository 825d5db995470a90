// Finds servos of a model that are too stiff for their load, so that the simulation diverges.
//
// A servo of stiffness k and damping c on a joint or tendon that moves the inertia M, integrated in
// steps dt with implicit damping, is stable while k dt^2 < 4 M + 2 c dt: above that it overshoots
// more with every step.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct UnstableServo {
  int actuator = -1;
  double gain = 0;       // its kp
  double limit = 0;      // the kp from which on it diverges
  std::string too_high;  // "the gain 5e+09 of servo 'x' is too high for joint 'y', which moves ..."
  std::string remedy;    // "Give it a lower one: edits: [...]"

  std::string text() const { return too_high + ". " + remedy; }
};

// Finds unstable servos in the subtree of a robot's base body. Names are without the robot's
// `prefix`.
std::vector<UnstableServo> UnstableServos(const mjModel* model, int base_body,
                                          std::string_view prefix);

// Springs of joints and tendons in that subtree that are too stiff in the same way, as sentences
// with the remedy: they diverge with any servos.
std::vector<std::string> UnstableSprings(const mjModel* model, int base_body,
                                         std::string_view prefix);

// Rounds a gain for advice down to one digit: "2000", "0.05".
std::string RoundedGain(double value);

}  // namespace robocell::internal
