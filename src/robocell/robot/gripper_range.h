// Measuring a gripper: how far apart its fingers are at two values of its control.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robocell/robot/finger.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// The behaviour of a gripper at the two ends of its control.
struct GripperRange {
  std::vector<GripperCtrl> ctrl;  // of each actuator
  GripperDistance distance;
  // Fingers may meet before the controls are at `closed`: so far from closed (0) to open (1) they
  // stay together. 0 where that is less than a fifth of the way.
  double meets = 0;
};

// The moving and the measured parts, as ids in the scene's present model.
struct GripperParts {
  int robot_body = -1;  // the robot is this body's subtree
  std::vector<int> ctrl_addresses;
  FingerPair pair;
};

// The finger distance (m) once the fingers came to rest after the controls (one for each of
// ctrl_addresses; NaN leaves that of home) were set to the first values, and then to the second. At
// rest they move less than a quarter of a millimetre in a quarter
// of a second, a second after the control was set or later: linkages go on creeping by fractions of
// a millimetre for long. What dry friction holds creeps on steadily, and counts as at rest too.
// Done in a copy of the model without gravity, in which the robot touches nothing but itself, from
// the scene's home: the present state plays no part, and the numbers are the same each time.
// EngineError when the copy diverges; ArgumentError when the fingers are not at rest after 20 s.
// Takes milliseconds to a second, for large models, more where fingers are slow; once for all
// scenes on a frozen one.
std::array<double, 2> SettledFingerDistances(const Scene& scene, const GripperParts& parts,
                                             const std::array<std::vector<double>, 2>& ctrl);

// The value of a joint at the same two ends. The same errors.
std::array<double, 2> SettledJointValues(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl, int joint);

// Contacts of the fingers at the end of that: "'forearm' and 'left_finger'", names of bodies, each
// pair once. Measures again, for messages.
std::vector<std::string> TouchingFingers(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl);

// The geoms of the two fingers that overlap at both ends of that, the deepest where several do, so
// that their distance is 0 whatever else opens. Measures anew, for messages.
std::optional<std::array<int, 2>> OverlapOfFingers(const Scene& scene, const GripperParts& parts,
                                                   const std::array<std::vector<double>, 2>& ctrl);

// "0.7", of several actuators "[0.7, -0.7]".
std::string CtrlText(const std::vector<double>& ctrl);

}  // namespace robocell::internal
