// FoldedChain: a serial chain in as few numbers as possible, for kernels that handle many poses at
// once.
//
// Between two joint axes there are a length along their common normal and a twist about it; the
// rest of a joint is a turn about and a shift along its own axis, to which the joint's value is
// simply added (J. Denavit and R. S. Hartenberg, "A Kinematic Notation for Lower-Pair Mechanisms",
// 1955). The common normal of nearly, but not exactly, parallel axes is far away, where digits are
// lost: their link keeps its whole transform.
//
//   pose of the tip = base * screw(0) * link(1) * screw(1) * ... * screw(n-1) * tip
//
// Lengths are in units of the chain's `length`, so that a kernel can weigh them against angles.
// Plain numbers only: this header may be used by code for any instruction set.
#pragma once

#include "robocell/kinematics/joint_count.h"

namespace robocell {
struct ChainModel;
}

namespace robocell::internal {

// A rigid transform of plain numbers.
struct PlainTransform {
  double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // row by row
  double translation[3] = {};
};

struct FoldedJoint {
  // The link from the previous joint, along the common normal and about it. Not for joint 0.
  bool whole_link = false;  // `link` instead
  double normal_length = 0, cos_twist = 1, sin_twist = 0;
  PlainTransform link;
  // The joint's own screw: turned by (hinge: value +) angle, shifted by (slide: value * per_metre
  // +) shift.
  bool slide = false;
  double angle = 0, shift = 0;
  double cos_angle = 1, sin_angle = 0;  // cosine and sine of `angle`, for slides
  double lower = 0, upper = 0;          // rad or m; +-infinity without limits
  // A hinge whose limits exclude no direction: positions beyond them are whole turns from inside.
  bool has_whole_turn = false;
  // Other joints follow it, so that whole turns of it may move the tip.
  bool leads = false;
};

struct FoldedCoupling;

struct FoldedChain {
  int n = 0;
  bool has_whole_turns = false;  // some joint
  double length = 1;             // m
  double per_metre = 1;          // 1 / length
  FoldedJoint joints[kMaxChainJoints];
  PlainTransform base;  // base body -> first screw
  PlainTransform tip;   // last screw -> tip
  // Set if joints follow others. `joints` then are the degrees of freedom, whose limits and kinds
  // count; screws and links are in here.
  const FoldedCoupling* coupling = nullptr;
};

// See CoupledLinks (chain_model.h): the value of joint i of the links is a polynomial of the value
// of degree of freedom leader[i].
struct FoldedCoupling {
  FoldedChain links;
  int leader[kMaxChainJoints] = {};
  double from[kMaxChainJoints] = {};
  double polynomial[kMaxChainJoints][5] = {};
  // Factor of a joint's column of the Jacobian in that of its leader, for a slope of 1: columns of
  // slides are per length of the chain.
  double unit[kMaxChainJoints] = {};
};

// Folds a chain in which no joint follows another one.
FoldedChain Fold(const ChainModel& chain);

struct CoupledFold {
  FoldedChain chain;  // without its pointer to `coupling`
  FoldedCoupling coupling;
};
// Folds a chain in which some do.
CoupledFold FoldCoupled(const ChainModel& chain);

}  // namespace robocell::internal
