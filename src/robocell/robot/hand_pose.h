// Named poses of a hand (MoveGroupConfig::poses) as controls of its actuators. Private to robot.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/group_core.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// Returns the controls of a pose of the group, one for each of its actuators. A joint's position is
// the control with which the position servo on it rests there. Actuators that the pose leaves out
// stay as in the pose `open`, and those that `open` leaves out as at home. Throws ArgumentError with
// the place of the value for a joint that no position servo moves alone, and for a control outside
// the actuator's range.
std::vector<double> CtrlOfPose(const GroupCore& group, const MoveGroupConfig& config,
                               const std::string& pose);

// Throws ArgumentError about a field of the group's configuration ("poses.open.thumb"), with its
// place in the robot's file.
[[noreturn]] void FailAtField(const GroupCore& group, const std::string& field,
                              const std::string& message);

}  // namespace robocell::internal
