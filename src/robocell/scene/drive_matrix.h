// The actuators of an arm whose lengths are sums over its degrees of freedom: servos on fixed
// tendons (a differential wrist, a telescope) and on joints that follow those of the arm
// (mujoco/couplings.h).
//
//   length of actuator a = sum over terms of coefficient * polynomial(q[joint])
//
// The matrix of the slopes of all lengths must have the rank of the arm's degrees of freedom: then
// every configuration has one set of lengths, and every set of joint torques at least one of
// forces. Where an actuator acts on each joint alone none of this is needed.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell::internal {

// A part of an actuator's length, gear included.
struct LengthTerm {
  std::size_t joint = 0;  // index of a degree of freedom
  double coefficient = 1;
  JointPolynomial of_joint;
};
using DriveLength = std::vector<LengthTerm>;
struct DriveLengths {
  std::vector<DriveLength> of_actuators;
};

// Returns the length of an actuator over degrees of freedom (joint ids) and their followers; unset
// if it acts on anything else, or not through joints and fixed tendons alone.
std::optional<DriveLength> LengthOver(const mjModel* model, int actuator,
                                      std::span<const int> joints,
                                      std::span<const JointFollower> followers);

inline double LengthAt(const DriveLength& length, std::span<const double> q) {
  double sum = 0;
  for (const LengthTerm& term : length) sum += term.coefficient * term.of_joint.at(q[term.joint]);
  return sum;
}

// Returns the slopes of all lengths, one row per actuator, one column per degree of freedom.
Eigen::MatrixXd DriveMatrix(std::span<const DriveLength> lengths, std::span<const double> q);

// Returns the actuators that move an arm together, in the order of the first joints they act on:
// all of a kind that act on its degrees of freedom and their followers alone. Position servos come
// before velocity servos and motors. Empty if their matrix lacks rank. Added actuators of control
// modes do not count.
std::vector<int> FindMatrixDrive(const mjModel* model, std::span<const int> joints);

// Returns why these actuators cannot move an arm together; "" if they can.
std::string WhyNoMatrixDrive(const mjModel* model, std::span<const int> joints,
                             std::span<const int> actuators);

}  // namespace robocell::internal
