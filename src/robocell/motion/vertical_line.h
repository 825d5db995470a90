// Straight lines up from a TCP pose, as joint motions: the path of a hand that leaves or approaches
// an object.
#pragma once

#include <Eigen/Core>

#include "robocell/kinematics/chain.h"
#include "robocell/motion/joint_path.h"
#include "robocell/robot/task_space.h"

namespace robocell::internal {

inline constexpr double kLineIkTolerance = 1e-4;  // m and rad
inline constexpr int kLinePoints = 4;             // besides the start
// An arm that cannot take every pose, or of whose pose only a part counts, may turn its hand by so
// much, rad, from the wanted rotation.
inline constexpr double kMostTilt = 0.15;

// Returns joint positions along the line from the TCP pose `tcp` (base frame), which `q` has, to
// `height` metres along `up` (base frame, unit length), with constant orientation; where the task
// space of the arm allows another one, within kMostTilt. The line ends where the arm gets no further
// without changing its posture; a complete one has kLinePoints + 1 points.
JointPath LineAbove(const Chain& chain, const TaskSpace& task, const Pose& tcp,
                    const JointVector& q, const Eigen::Vector3d& up, double height);

// Returns the share of such a line that the arm cannot follow, 0 to 1.
double MissingShare(const JointPath& line);

}  // namespace robocell::internal
