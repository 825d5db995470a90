// Measures a gripper: the distance of its fingers at two values of its control.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robocell/robot/finger.h"
#include "robocell/robot/finger_path.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// The behaviour of a gripper at the two ends of its control.
struct GripperRange {
  std::vector<GripperCtrl> ctrl;  // controls of each actuator
  GripperDistance distance;
  // Fingers may meet before the controls are at `closed`: up to this share from closed (0) to open
  // (1) they stay together. 0 if that is less than a fifth of the way.
  double meets = 0;
  std::optional<FlatDistance> flat;
  std::optional<PressedFingers> pressed;
  std::vector<double> pushed;  // forces of the actuators while they press
};

// The moving and the measured parts, as ids in the scene's present model.
struct GripperParts {
  int robot_body = -1;  // the robot is this body's subtree
  std::vector<int> ctrl_addresses;
  FingerPair pair;
};

// Returns the actuators of the controls.
std::vector<int> ActuatorsOf(const mjModel* model, const GripperParts& parts);

// Returns the finger distances (m) after the fingers came to rest with the controls (one for each
// of ctrl_addresses; NaN leaves that of home) at the first values, and then at the second. At rest
// they move less than a quarter of a millimetre in a quarter of a second, a second or more after
// the control was set: linkages creep by fractions of a millimetre for long. Fingers that dry
// friction holds creep steadily, and count as at rest too.
// The measurement uses a copy of the model without gravity, in which the robot touches nothing but
// itself, and starts from the scene's home: the present state plays no part, and the numbers are
// always the same.
// Throws EngineError if the copy diverges, and ArgumentError if the fingers are not at rest after
// 20 s. Takes milliseconds to a second, for large models, and longer for slow fingers; it runs once
// for all scenes on a frozen one.
struct SettledFingers {
  std::array<double, 2> distances = {};
  std::optional<FlatDistance> flat;  // flat part on the way from the first controls to the second
  std::optional<PressedFingers> pressed;  // pressed fingers at the second controls
  std::vector<double> pushed;             // forces of the actuators there
};
SettledFingers SettleFingers(const Scene& scene, const GripperParts& parts,
                             const std::array<std::vector<double>, 2>& ctrl);

// The value of a joint at the same two ends. The same errors.
std::array<double, 2> SettledJointValues(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl, int joint);

// Returns contacts of the fingers at the end of that: "'forearm' and 'left_finger'", names of
// bodies, each pair once. Measures again, for messages.
std::vector<std::string> TouchingFingers(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl);

// Returns the geoms of the two fingers that overlap at both ends of that (the deepest pair), so
// that their distance is always 0. Measures again, for messages.
std::optional<std::array<int, 2>> OverlapOfFingers(const Scene& scene, const GripperParts& parts,
                                                   const std::array<std::vector<double>, 2>& ctrl);

// Formats "0.7", or for several actuators "[0.7, -0.7]".
std::string CtrlText(const std::vector<double>& ctrl);

}  // namespace robocell::internal
