// What of a target pose is asked for, in numbers: options resolved once for many targets. For the
// solvers of this folder.
#pragma once

#include <algorithm>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

struct IkTask {
  explicit IkTask(const IkOptions& options);

  // How far off a tip is, as norms, weights and cone taken into account. (Of what is plain it is
  // the pose error; solvers do not ask.)
  struct Errors {
    double position = 0, rotation = 0;  // m, rad
  };
  Errors ErrorsOf(const Transform& target, const Transform& tip) const;

  // The whole pose, no weights.
  bool plain = true;
  // Any rotation will do.
  bool position_only = false;
  // Every position error counts at least what it is.
  bool whole_position = true;
  // How many of the six numbers of a pose count.
  int rows = 6;
  // How many joints of so many are to spare with these locked; less than 0: most poses are not to
  // be reached at all.
  int joints_to_spare(int joints, const LockedJoints& locked) const {
    return joints - static_cast<int>(std::count(locked.begin(), locked.begin() + joints, true)) -
           rows;
  }
  // Whether solutions are endlessly many.
  bool leaves_joints(int joints, const LockedJoints& locked) const {
    return joints_to_spare(joints, locked) > 0;
  }
  // Only `axis`, in the tip's frame, has to point where the target's points, or within `cone` rad.
  bool swing = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double cone = 0;
  // Of what is left to move and to turn in the axes of the target: the rows that count.
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity(), angular = Eigen::Matrix3d::Identity();
};

// ArgumentError for weights, axes and cones that make no sense.
void RequireIkTask(const IkOptions& options);

}  // namespace robocell::internal
