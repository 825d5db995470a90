// Joints that follow another one: the equality constraints of a model that make the value of a
// hinge or slide a polynomial of the value of another (mjEQ_JOINT). Mechanisms are written like
// that: parallelograms, telescopes, mimic joints of URDF.
//
// Chains of couplings are composed: where s3 follows s2 and s2 follows s1, both follow s1. What
// cannot be composed is a problem of the joints concerned, not of the model: a gripper's linkage
// does not concern an arm.
//
// Constraints that are inactive in the model do not count. Ids are not checked.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

// value(x) = c[0] + c[1] (x - from) + ... + c[4] (x - from)^4, rad or m.
struct JointPolynomial {
  double from = 0;
  std::array<double, 5> c{0, 1, 0, 0, 0};

  double at(double x) const {
    const double d = x - from;
    return c[0] + d * (c[1] + d * (c[2] + d * (c[3] + d * c[4])));
  }
  double slope(double x) const {
    const double d = x - from;
    return c[1] + d * (2 * c[2] + d * (3 * c[3] + d * 4 * c[4]));
  }
  double curvature(double x) const {
    const double d = x - from;
    return 2 * c[2] + d * (6 * c[3] + d * 12 * c[4]);
  }
  bool affine() const { return c[2] == 0 && c[3] == 0 && c[4] == 0; }
  bool operator==(const JointPolynomial&) const = default;
};

// Returns outer(inner(x)). At most one of them may bend: the result would have a higher degree.
JointPolynomial Compose(const JointPolynomial& outer, const JointPolynomial& inner);
// Returns x as a polynomial of the value of an affine one whose slope is not 0.
JointPolynomial Inverse(const JointPolynomial& affine);

// A joint whose value follows from that of its leader, which follows no other joint. A joint that a
// constraint holds in place has no leader: -1, and a constant polynomial.
struct CoupledJoint {
  int joint = -1, leader = -1;
  JointPolynomial of_leader;
};

struct ModelCouplings {
  std::vector<CoupledJoint> followers;  // by joint id
  // Joints whose couplings cannot be composed, with the reason.
  struct Problem {
    std::vector<int> joints;
    std::string why;
  };
  std::vector<Problem> problems;

  // Returns the entry of a joint; null if it follows no other.
  const CoupledJoint* Of(int joint) const;
  // Returns the problem that a joint is part of; null if there is none.
  const Problem* ProblemOf(int joint) const;
  // Returns the joint that leads this one; itself if it follows no other; -1 if it is held.
  int LeaderOf(int joint) const;
};

ModelCouplings FindCouplings(const mjModel* model);

}  // namespace robocell
