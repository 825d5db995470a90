// The arms of a robot by the names under which Robot::Of sees the robot from each of them. A robot
// with one arm has its plain name; one with several has "torso/left" and "torso/right".
//
//   for (const std::string& name : ActingArms(robot.config(), robot.name()))
//     Robot::Of(scene, name).gripper().SetOpening(1);   // each arm's own hand
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// Returns the groups of kind arm, in the order of the file.
std::vector<std::string> ArmNames(const RobotConfig& config);

// Returns the configuration with this arm before the others: it is the first arm then.
RobotConfig WithArmFirst(const RobotConfig& config, const std::string& arm);

// Returns the names of a robot seen from each of its arms. A robot without an arm has its plain name.
std::vector<std::string> ActingArms(const RobotConfig& config, const std::string& robot);
// Returns the same for all robots of a scene that have an arm.
std::vector<std::string> ActingArms(const Scene& scene);

// Returns the name with which Robot::Of returns this robot with this first arm, in any scene.
std::string ActingName(const Robot& robot);

}  // namespace robocell::internal
