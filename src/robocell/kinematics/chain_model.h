// ChainModel: the numbers of a serial chain, folded so that forward kinematics is one product per
// joint.
//
// Every joint has a frame whose z axis is the joint's axis and whose origin lies on it; the
// transform from the moved frame of the previous joint (for the first one: from the base body) is
// constant. Solvers read this. It has no pointers and no names; users hold a Chain (chain.h).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/kinematics/transform.h"
#include "robocell/mujoco/couplings.h"

namespace robocell {

// Everything that moves rigidly behind one joint and before the next, in the moved joint frame.
struct LinkInertia {
  double mass = 0;                                          // kg
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();         // mass * centre of mass, kg m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();        // about the frame's origin, kg m^2
  double weight_mass = 0;                                   // sum of mass * (1 - gravcomp), kg
  Eigen::Vector3d weight_moment = Eigen::Vector3d::Zero();  // the same for mass * centre of mass
};

// Transforms an inertia to another frame; `frame` is the pose of the first in the other.
LinkInertia InFrame(const Transform& frame, const LinkInertia& link);

// Requires both in the same frame.
LinkInertia& operator+=(LinkInertia& link, const LinkInertia& more);
LinkInertia& operator-=(LinkInertia& link, const LinkInertia& less);

struct JointModel {
  Transform
      fixed;  // moved frame of the joint before -> this joint's frame at its reference position
  Transform joint_to_body;  // moved joint frame -> the body that the joint moves
  LinkInertia link;
  bool slide = false;
  double reference =
      0;  // joint position at which the joint's transform is the identity (the model's qpos0)
  double lower = 0, upper = 0;  // +-infinity without limits
  double armature = 0;          // kg m^2 or kg
};

struct CoupledLinks;

struct ChainModel {
  int n = 0;  // degrees of freedom
  // Bound of the tip's distance from the first joint's reference origin for configurations within
  // the limits, m; infinity with a slide without limits.
  double reach_bound = 0;
  // Characteristic length of the chain, which weighs lengths against angles: the bound without the
  // slides' travel, never 0.
  double length = 1;
  std::array<JointModel, kMaxChainJoints> joints;
  Transform last_to_tip;  // moved frame of the last joint -> tip
  // Set if joints follow others. `joints` then are the degrees of freedom, with limits that their
  // followers obey too; frames and inertias, except the first `fixed` and `last_to_tip`, are those
  // of the links in here.
  std::shared_ptr<const CoupledLinks> coupled{};
};

// Inertia that couples two joints of a chain at any distance: rotors behind tendons. Accelerating
// one of them takes this much of the other, kg m^2, kg m or kg. The part that acts on a joint alone
// belongs to its armature.
struct JointCoupling {
  int first = 0, second = 0;  // joints of the chain, first < second
  double inertia = 0;
};

// All joints of a chain in which some follow others: joint i has the value
// polynomial[i](x[leader[i]]), where x are the degrees of freedom.
struct CoupledLinks {
  ChainModel links;
  // A joint that is held in place has leader 0 and a constant polynomial; a leader leads itself.
  std::array<int, kMaxChainJoints> leader{};
  std::array<JointPolynomial, kMaxChainJoints> polynomial{};
  std::array<int, kMaxChainJoints> joint_of{};  // joint of each degree of freedom
  int n = 0;                                    // degrees of freedom
  std::vector<JointCoupling> tendons{};

  void Expand(const double* x, double* q) const {
    for (int i = 0; i < links.n; ++i) q[i] = polynomial[i].at(x[leader[i]]);
  }
  // Computes how fast each joint moves with its leader.
  void Slopes(const double* x, double* slopes) const {
    for (int i = 0; i < links.n; ++i) slopes[i] = polynomial[i].slope(x[leader[i]]);
  }
};

// Returns the chain of all joints, whose frames and inertias count.
inline const ChainModel& LinksOf(const ChainModel& chain) {
  return chain.coupled ? chain.coupled->links : chain;
}

// Returns the unit of a joint for solvers that weigh joints against each other: 1 rad for a hinge,
// the chain's length in m for a slide.
inline double UnitOf(const ChainModel& chain, int joint) {
  return chain.joints[joint].slide ? chain.length : 1;
}

// Frames of all joints of a configuration, in the base frame. Only the first n entries, of LinksOf
// the chain, are written.
struct ChainFrames {
  std::array<Eigen::Vector3d, kMaxChainJoints> axis;    // unit vectors
  std::array<Eigen::Vector3d, kMaxChainJoints> origin;  // a point on the axis, m
  Transform tip;
};

// Applies the joint's motion to the frame of the joint at its reference position.
inline void MoveJoint(const JointModel& joint, double q, Transform* frame) {
  const double d = q - joint.reference;
  if (joint.slide) {
    frame->translation += frame->rotation.col(2) * d;
    return;
  }
  const double c = std::cos(d), s = std::sin(d);
  const Eigen::Vector3d x = frame->rotation.col(0), y = frame->rotation.col(1);
  frame->rotation.col(0) = c * x + s * y;
  frame->rotation.col(1) = c * y - s * x;
}

// Calls visit(i, moved frame of joint i in the base frame) for each joint, of LinksOf the chain, and
// returns the tip in the base frame.
template <typename Visit>
Transform WalkChain(const ChainModel& chain, const double* q, Visit&& visit) {
  if (chain.coupled) {
    std::array<double, kMaxChainJoints> all;
    chain.coupled->Expand(q, all.data());
    return WalkChain(chain.coupled->links, all.data(), visit);
  }
  Transform frame;
  for (int i = 0; i < chain.n; ++i) {
    frame = i == 0 ? chain.joints[0].fixed : frame * chain.joints[i].fixed;
    MoveJoint(chain.joints[i], q[i], &frame);
    visit(i, frame);
  }
  return frame * chain.last_to_tip;
}

inline void ComputeFrames(const ChainModel& chain, const double* q, ChainFrames* out) {
  out->tip = WalkChain(chain, q, [out](int i, const Transform& frame) {
    out->axis[i] = frame.rotation.col(2);
    out->origin[i] = frame.translation;
  });
}

}  // namespace robocell
