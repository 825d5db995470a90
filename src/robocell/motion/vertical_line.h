// Straight lines up from a TCP pose, as joint motions: the path of a hand that leaves or approaches
// an object.
#pragma once

#include <Eigen/Core>

#include "robocell/kinematics/chain.h"
#include "robocell/motion/joint_path.h"

namespace robocell::internal {

inline constexpr double kLineIkTolerance = 1e-4;  // m and rad
inline constexpr int kLinePoints = 4;             // besides the start
// An arm of fewer than six joints may turn its hand by so much, rad, from the wanted rotation.
inline constexpr double kMostTilt = 0.15;

// Returns joint positions along the line from the TCP pose `tcp` (base frame), which `q` has, to
// `height` metres along `up` (base frame, unit length), with constant orientation (fewer than six
// joints: the nearest one, within kMostTilt). The line ends
// where the arm gets no further without changing its posture; a complete one has kLinePoints + 1
// points.
JointPath LineAbove(const Chain& chain, const Pose& tcp, const JointVector& q,
                    const Eigen::Vector3d& up, double height);

// Returns the share of such a line that the arm cannot follow, 0 to 1.
double MissingShare(const JointPath& line);

}  // namespace robocell::internal
