// One try of inverse kinematics: damped least-squares steps from a start until the tip is there or
// progress ends.
//
// Internal to ik.cc. Everything is on the stack; limits hold after every step.
#pragma once

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/pose_error.h"

namespace robocell {

class IkDescent {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  IkDescent(const ChainModel& chain, const Transform& target, const IkOptions& options);

  // Moves q to the target. True when it got there.
  bool Run(double* q);
  // From a solution, moves q towards `goal` as far as the tip's task leaves joints to spare. False,
  // and q is no solution, when that led astray.
  bool Approach(const double* goal, double* q);

  // Of the last q, in metres and radians.
  double position_error() const { return position_error_; }
  double rotation_error() const { return rotation_error_; }
  // One number for "how wrong", lengths in units of the chain's.
  double cost() const;
  int iterations() const { return iterations_; }

 private:
  using Jacobian = Eigen::Matrix<double, 6, kMaxChainJoints>;

  void Evaluate(const double* q);
  bool Arrived() const;
  void ComputeJacobian();
  // One damped step plus as much of `spare` as does not move the tip; spare may be null.
  void Step(const double* spare, double* q);
  // The step with the joints in `active` only. False when one of them pressed on its limit and was
  // taken out.
  bool TrySolve(const double* q, const double* spare, std::array<bool, kMaxChainJoints>* active,
                double* step) const;

  const ChainModel& chain_;
  const Transform& target_;
  const IkOptions& options_;
  double per_metre_;  // weight of a length
  ChainFrames frames_;
  Jacobian jacobian_;
  Vector6 error_;  // weighted
  double position_error_ = 0, rotation_error_ = 0;
  int iterations_ = 0;
};

}  // namespace robocell
