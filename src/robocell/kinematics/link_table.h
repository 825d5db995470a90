// LinkTable: a chain's numbers with one column per link, for kernels that work on all links at
// once.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

#include "robocell/kinematics/joint_count.h"

namespace robocell {

struct LinkTable {
  using Row = double[kMaxChainJoints];

  int n = 0;
  // Transform from the previous joint, column by column. The first joint's translation is `origin`
  // instead: kernels count from there, so that a far base costs no digits.
  alignas(64) Row rotation[9] = {};
  alignas(64) Row translation[3] = {};
  alignas(64) Row reference = {};
  alignas(64) Row turns = {};   // 1 for a hinge
  alignas(64) Row slides = {};  // 1 for a slide
  // LinkInertia; the inertia as xx, yy, zz, xy, xz, yz.
  alignas(64) Row mass = {};
  alignas(64) Row moment[3] = {};
  alignas(64) Row inertia[6] = {};
  alignas(64) Row weight_mass = {};
  alignas(64) Row weight_moment[3] = {};
  alignas(64) Row armature = {};
  // Sums over the link and those behind it.
  alignas(64) Row mass_behind = {};
  alignas(64) Row weight_behind = {};
  double origin[3] = {};
  double tip_rotation[9] = {};  // column by column
  double tip_translation[3] = {};
};

struct ChainModel;
LinkTable Tabulate(const ChainModel& chain);

}  // namespace robocell
