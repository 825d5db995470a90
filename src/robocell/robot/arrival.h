// The condition that the joints of an arm have arrived at their target, shared by environments,
// experts and the trial of a robot's file.
//
//   const std::vector<double> tolerances = ArrivalTolerances(robot, "arm");
//   if (AreWithin(q, target, tolerances)) ...
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

// Returns the tolerances within which each joint of the group has arrived, rad or m, from the
// robot's configuration. Joints of one degree of freedom.
std::vector<double> ArrivalTolerances(const Robot& robot, const std::string& group);

// Returns the time after which the last of the group's actuators follows its control, s; 0 without
// delays.
double LargestDelay(const Robot& robot, const std::string& group);

// Returns true if each joint is within `times` its tolerance of its target. No allocation.
bool AreWithin(std::span<const double> q, std::span<const double> target,
               std::span<const double> tolerances, double times = 1);

}  // namespace robocell::internal
