// When the joints of an arm have arrived where they were sent: one answer for environments, experts
// and the trial of a robot's file.
//
//   const std::vector<double> tolerances = ArrivalTolerances(robot, "arm");
//   if (AreWithin(q, target, tolerances)) ...
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

// Within which each joint of the group has arrived, rad or m, as the robot's configuration says.
// Joints of one degree of freedom.
std::vector<double> ArrivalTolerances(const Robot& robot, const std::string& group);

// Returns true if each joint is within `times` its tolerance of its target. No allocation.
bool AreWithin(std::span<const double> q, std::span<const double> target,
               std::span<const double> tolerances, double times = 1);

}  // namespace robocell::internal
