// What `robot.kinematics` is in Python: the robot's kinematic functions under one name.
#pragma once

#include "bindings.h"
#include "robocell/robot/robot.h"

namespace robocell::python {

struct Kinematics {
  Robot robot;
};

// A PyKDL.Chain; ImportError with the install line when PyKDL is missing.
nb::object ToPyKdl(const Chain& chain);

}  // namespace robocell::python
