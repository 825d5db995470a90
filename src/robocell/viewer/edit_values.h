// What the sliders of a viewer show and change: positions of joints and controls of actuators.
// Internal to viewer/.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/viewer/panels.h"

namespace robocell::internal {

// Return the names of hinges and slides, and of actuators with one input.
std::vector<std::string> ScalarJoints(const mjModel* model);
std::vector<std::string> NamedActuators(const mjModel* model);

// Return the range of a slider: the limits, else a turn, a metre or 1 in both directions.
SliderRange JointRange(const mjModel* model, const std::string& joint);
SliderRange ControlRange(const mjModel* model, const std::string& actuator);
double JointValue(const Scene& scene, const std::string& joint);
double ControlValue(const Scene& scene, const std::string& actuator);

// Moves a joint. A robot whose arm has it holds the new position.
void SetJoint(const Scene& scene, const std::vector<Robot>& robots, const std::string& joint,
              double value);
// Sets a control. If a robot drives the actuator in position mode, its command changes too, so that
// Robot::Update() keeps the value.
void SetControl(const Scene& scene, const std::vector<Robot>& robots, const std::string& actuator,
                double value);

}  // namespace robocell::internal
