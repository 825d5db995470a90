// The requested part of a target pose, in numbers: options resolved once for many targets. For the
// solvers of this folder.
#pragma once

#include <algorithm>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

struct IkTask {
  explicit IkTask(const IkOptions& options);

  // The errors of a tip, as norms, with weights and cone. (For a plain task this is the pose error;
  // solvers do not use it then.)
  struct Errors {
    double position = 0, rotation = 0;  // m, rad
  };
  Errors ErrorsOf(const Transform& target, const Transform& tip) const;

  // True for the whole pose without weights.
  bool plain = true;
  // True if any rotation is accepted.
  bool position_only = false;
  // True if every position error counts at least fully.
  bool whole_position = true;
  // Number of constrained pose components, of six.
  int rows = 6;
  // Returns the number of redundant joints with these locked; below 0 most poses cannot be reached
  // at all.
  int joints_to_spare(int joints, const LockedJoints& locked) const {
    return joints - static_cast<int>(std::count(locked.begin(), locked.begin() + joints, true)) -
           rows;
  }
  // Returns true if there are infinitely many solutions.
  bool leaves_joints(int joints, const LockedJoints& locked) const {
    return joints_to_spare(joints, locked) > 0;
  }
  // True if only `axis`, in the tip's frame, has to agree with the target's, within `cone` rad.
  bool swing = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double cone = 0;
  // The rows of the remaining translation and rotation that count, in the axes of the target.
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity(), angular = Eigen::Matrix3d::Identity();
};

// Throws ArgumentError for meaningless weights, axes and cones.
void RequireIkTask(const IkOptions& options);

}  // namespace robocell::internal
