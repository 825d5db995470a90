// How well a chain's tip can move in all directions.
//
//   const double w = Manipulability(chain, q);
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"

namespace robocell {

// The volume of the tip twists that joint speeds of unit norm make: the square root of det(J J^T)
// (T. Yoshikawa, "Manipulability of Robotic Mechanisms", 1985), metres and radians; with fewer than
// six joints of det(J^T J). 0 where a direction is lost. ArgumentError as Chain::Jacobian has it.
double Manipulability(const Chain& chain, std::span<const double> q);

// The same unchecked, for the solvers of this folder.
double ManipulabilityOf(const ChainModel& chain, const double* q);
// The gradient of its logarithm by q, into n numbers; finite everywhere. Where a direction is
// nearly lost it points steeply to where it is found again.
void LogManipulabilityGradient(const ChainModel& chain, const double* q, double* gradient);

}  // namespace robocell
