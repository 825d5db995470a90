// What `robot.kinematics` is in Python: the robot's kinematic functions under one name.
#pragma once

#include "robocell/robot/robot.h"

namespace robocell::python {

struct Kinematics {
  Robot robot;
};

}  // namespace robocell::python
