// Inverse kinematics for a step of a motion: joint values near those before it.
//
// Ik takes the first solution that it finds. That may have the elbow or the wrist on their other
// side, and an arm that is sent there swings on its way however small the step of its tip was. For
// IkStep a solution is one only when no joint goes farther than such a step may take it; without
// one it fails, as an arm has to stop there. Large steps are free to take any solution.
//
//   const IkResult next = IkStep(chain, target, commanded);
//   if (next.success) Command(next.q);
//
// A step may have no solution nearby, as beside a singularity: IkTowards goes as far as it can.
#pragma once

#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"

namespace robocell::internal {

// How far a joint may go while the tip goes from one pose to another: kLeastJointStep and
// kJointStepGain for each radian that it turns and each chain length (ChainModel::length) that it
// moves. Radians for hinges, chain lengths for slides.
inline constexpr double kLeastJointStep = 0.3;
inline constexpr double kJointStepGain = 4;
double LargestJointStep(const Chain& chain, const Pose& from, const Pose& to);

// The joint values for `tip_in_base` near `from`, the joint values before. Errors as of Ik. Nothing
// is allocated when the search from there succeeds.
IkResult IkStep(const Chain& chain, const Pose& tip_in_base, std::span<const double> from);

// Returns joint values near `from` that bring the tip as near to `tip_in_base` as damped
// differential steps (differential_ik.h) can, while no joint moves farther than LargestJointStep
// from `from`. Of two ways that lead equally far, as of an elbow that can bend to both sides, it
// takes the one with more room to the joint limits. `success` says that at least a fiftieth of the
// pose error is gone; the errors are the rest. Angles are weighed against lengths by the chain's
// length. Errors as in Ik. No allocation; 0.2 ms on average from singular places, a few
// milliseconds where nothing helps.
//
//   const IkResult next = IkTowards(chain, target, commanded);
//   if (next.success) Command(next.q);  // next.position_error is what is left
IkResult IkTowards(const Chain& chain, const Pose& tip_in_base, std::span<const double> from);

}  // namespace robocell::internal
