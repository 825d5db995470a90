// Inverse kinematics for a step of a motion: joint values near the previous ones.
//
// Ik takes the first solution that it finds. Its elbow or wrist may be on the other side, and an
// arm that is sent there swings even for a small step of its tip. IkStep only accepts a solution if
// no joint moves farther than such a step allows; without one it fails, and the arm has to stop
// there. Large steps may take any solution.
//
//   const IkResult next = IkStep(chain, target, commanded);
//   if (next.success) Command(next.q);
//
// A step may have no solution nearby, for example beside a singularity: IkTowards goes as far as it
// can.
#pragma once

#include <optional>
#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"

namespace robocell::internal {

// The largest motion of a joint while the tip moves from one pose to another: kLeastJointStep, and
// kJointStepGain for each radian of rotation and each chain length (ChainModel::length) of
// translation. Radians for hinges, chain lengths for slides.
inline constexpr double kLeastJointStep = 0.3;
inline constexpr double kJointStepGain = 4;
double LargestJointStep(const Chain& chain, const Pose& from, const Pose& to);

// Returns the metres that count as much as one radian in a step of the tip: the ratio of what is
// commanded, within a fiftieth of the chain's length (ChainModel::length) and all of it. A rotation
// alone leaves the tip where it is.
double LengthPerRadian(const Chain& chain, const Pose& from, const Pose& to);

// Returns joint values for `tip_in_base` near `from`, the previous joint values. Of `task` only the
// fields count that say which part of the pose is requested. No joint moves farther than `most`,
// rad or chain lengths; unset: LargestJointStep to the target. If a part of the pose does not
// count, the target may be far from the poses that are accepted, and the caller sets it. Throws the
// errors of Ik. Nothing is allocated when the search from there succeeds.
IkResult IkStep(const Chain& chain, const Pose& tip_in_base, std::span<const double> from,
                const IkOptions& task = {}, std::optional<double> most = {});

// Returns joint values near `from` that bring the tip as near to `tip_in_base` as damped
// differential steps (differential_ik.h) can, while no joint moves farther than LargestJointStep
// from `from`. Of two ways that lead equally far, for example of an elbow that can bend to both
// sides, it takes the one with more room to the joint limits. `success` is true if at least a
// fiftieth of the pose error is removed; the errors are the rest. Lengths are weighed
// against angles by LengthPerRadian. Throws the errors of Ik. No allocation; 0.2 ms on average from
// singular places, a few milliseconds if nothing helps.
//
//   const IkResult next = IkTowards(chain, target, commanded);
//   if (next.success) Command(next.q);  // next.position_error remains
IkResult IkTowards(const Chain& chain, const Pose& tip_in_base, std::span<const double> from);

}  // namespace robocell::internal
