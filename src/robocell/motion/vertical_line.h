// Straight lines up from a TCP pose, as joint motions: the way a hand leaves an object or comes to
// one.
#pragma once

#include <Eigen/Core>

#include "robocell/kinematics/chain.h"
#include "robocell/motion/joint_path.h"

namespace robocell::internal {

inline constexpr double kLineIkTolerance = 1e-4;  // m and rad
inline constexpr int kLinePoints = 4;             // besides the start

// Joint positions along the line from the TCP pose `tcp` (base frame), which `q` has, to `height`
// metres along `up` (base frame, unit length), the orientation kept. It ends where the arm gets no
// further without changing its posture: the line has kLinePoints + 1 points when it has all.
JointPath LineAbove(const Chain& chain, const Pose& tcp, const JointVector& q,
                    const Eigen::Vector3d& up, double height);

// The share of such a line that the arm does not get along, 0 to 1.
double MissingShare(const JointPath& line);

}  // namespace robocell::internal
