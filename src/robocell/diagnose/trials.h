// Private to diagnose: the list of all trials of a live robot. A new one is a file with a function
// and a line here. Checks of a compiled model are in scene/inspection/.
#pragma once

#include "robocell/robot/robot.h"
#include "robocell/scene/inspection/findings.h"

// Tries a live robot, which may be reset and stepped; it begins reset. The order is that of the
// findings.
#define ROBOCELL_ROBOT_TRIALS(TRIAL) \
  TRIAL(TryFirstArm)                 \
  TRIAL(TryFloatingBase)             \
  TRIAL(TryHomeContacts)             \
  TRIAL(TryFingerDistance)           \
  TRIAL(TryTcpPlaces)                \
  TRIAL(TryArms)                     \
  TRIAL(TryUndrivenGroups)

namespace robocell::internal {

struct TrialOptions {
  // Leaves out findings that the warnings of the robot's scene already contain.
  bool beside_warnings = false;
  // Checks for a run, whose task selects the arms.
  bool for_run = false;
};
using RobotTrial = void(Robot&, const TrialOptions&, Findings&);
#define ROBOCELL_DECLARE(function) RobotTrial function;
ROBOCELL_ROBOT_TRIALS(ROBOCELL_DECLARE)
#undef ROBOCELL_DECLARE

}  // namespace robocell::internal
