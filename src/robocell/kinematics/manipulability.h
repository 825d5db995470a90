// Manipulability: a measure of how well a chain's tip moves in all directions.
//
//   const double w = Manipulability(chain, q);
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"

namespace robocell {

// Returns the volume of the tip twists for joint speeds of unit norm: the square root of det(J J^T)
// (T. Yoshikawa, "Manipulability of Robotic Mechanisms", 1985), metres and radians; with fewer than
// six joints that of det(J^T J). 0 where a direction is lost. Throws ArgumentError as in
// Chain::Jacobian.
double Manipulability(const Chain& chain, std::span<const double> q);

// Returns the manipulability without checks, for the solvers of this folder.
double ManipulabilityOf(const ChainModel& chain, const double* q);
// Computes the gradient of its logarithm by q, n numbers; finite everywhere. Near a lost direction
// it points steeply away from the singularity.
void LogManipulabilityGradient(const ChainModel& chain, const double* q, double* gradient);

}  // namespace robocell
