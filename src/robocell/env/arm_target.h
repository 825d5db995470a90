// Computes the target of one arm, in the shared base frame or in joint space, as a pure function of
// its action and its previous target. No scene, no state.
//
//   const Pose to = MovedBy(last, Pose::FromRpy({0.01, 0, 0}, {0, 0, 0.1}));
//   const Pose sent = LimitedStep(last, to, 0.05, 0.2);
#pragma once

#include <span>

#include "robocell/math/pose.h"
#include "robocell/spec/env_action.h"

namespace robocell::internal {

// Returns the TCP moved by `delta`: translated along the axes of the pose's reference frame, and
// rotated about its own origin around these same axes.
Pose MovedBy(const Pose& tcp, const Pose& delta);

// Returns `to`, or the pose on the way from `from` at which the limit ends the step.
Pose LimitedStep(const Pose& from, const Pose& to, const StepLimit& limit);
void LimitJointStep(std::span<const double> from, double limit, std::span<double> to);

// Returns true if a quaternion of any length has a direction; [0, 0, 0, 0] has none.
bool HasDirection(std::span<const double> quaternion);

// Writes x y z and the quaternion xyzw into seven numbers.
void PutTquat(const Pose& pose, std::span<double> out);
// Writes them for an observation, with quaternion components in [-1, 1]: by rounding, those of a
// product may exceed 1 by a unit in the last place.
void ObserveTquat(const Pose& pose, std::span<double> out);

// Maps a hinge without limits into +-`most`, which is more than half a turn, by removing whole
// turns.
double ObservedTurn(double position, double most);

// Returns the pose of a Cartesian action: x y z and roll pitch yaw, or a quaternion xyzw, which is
// normalised; one of length zero is not a rotation.
Pose PoseOfAction(ControlMode mode, std::span<const double> action);

}  // namespace robocell::internal
