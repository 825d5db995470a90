// Inertia that couples joints of a chain, wherever they are: rotors behind tendons. What of it a
// joint feels alone is part of its armature.
#pragma once

namespace robocell {

// Accelerating one of the two joints takes this much of the other, kg m^2, kg m or kg.
struct JointCoupling {
  int first = 0, second = 0;  // joints of the chain, first < second
  double inertia = 0;
};

}  // namespace robocell
