// Private to diagnose: the list of all checks. A new one is a file with a function and a line here.
#pragma once

#include <span>

#include "robocell/diagnose/findings.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/robot_inspection.h"

// Checks a robot's compiled model. These run at every compile: they allocate little and step
// nothing. Each is in the file of the same name (CheckFingers in fingers.cc). The scale comes
// first: in a robot in millimetres it causes the findings of the others.
#define ROBOCELL_MODEL_CHECKS(CHECK) \
  CHECK(CheckScale)                  \
  CHECK(CheckFingers)                \
  CHECK(CheckRanges)                 \
  CHECK(CheckServos)                 \
  CHECK(CheckTendons)                \
  CHECK(CheckInertia)                \
  CHECK(CheckCameraPlaces)           \
  CHECK(CheckPedestals)

// Tries a live robot, which may be reset and stepped; it begins reset.
#define ROBOCELL_ROBOT_TRIALS(TRIAL) \
  TRIAL(TryFirstArm)                 \
  TRIAL(TryHomeContacts)             \
  TRIAL(TryFingerDistance)           \
  TRIAL(TryTcpPlaces)                \
  TRIAL(TryArms)                     \
  TRIAL(TryUndrivenGroups)

namespace robocell::internal {

using ModelCheck = void(const CompiledRobot&, Findings&);
#define ROBOCELL_DECLARE(function) ModelCheck function;
ROBOCELL_MODEL_CHECKS(ROBOCELL_DECLARE)
#undef ROBOCELL_DECLARE

struct TrialOptions {
  // Leaves out findings that the warnings of the robot's scene already contain.
  bool beside_warnings = false;
  // For a run, whose task chooses the arms.
  bool for_run = false;
};
using RobotTrial = void(Robot&, const TrialOptions&, Findings&);
#define ROBOCELL_DECLARE(function) RobotTrial function;
ROBOCELL_ROBOT_TRIALS(ROBOCELL_DECLARE)
#undef ROBOCELL_DECLARE

// Returns all checks, in the order of the lists, which is the order of their findings.
std::span<ModelCheck* const> ModelChecks();
std::span<RobotTrial* const> RobotTrials();

}  // namespace robocell::internal
