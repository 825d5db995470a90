// What a leaf that is moved by joints yields to forces, and the force that damps it: the part of
// Cartesian impedance that is small matrices, in the registers that link_kernel.h has.
// Instruction sets round differently.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

#include "robocell/kinematics/link_table.h"

namespace robocell {

namespace internal {
struct LinkAnswer;  // kinematics/link_kernel.h
}
using internal::LinkAnswer;

// What holds the leaf, along and about the axes of the base.
struct LeafSprings {
  double stiffness[6] = {};  // N/m, then Nm/rad
  double root[6] = {};       // of it: the coordinates in which all springs are alike
};

LeafSprings MakeLeafSprings(const double* stiffness);

// Where the leaf shall be, in the robot base frame.
struct LeafGoal {
  const double* position = nullptr;
  const double* axes = nullptr;  // the leaf's, one after the other
};

// The linear part before the angular part, in the axes of the base.
struct LeafQuery {
  int n = 0;  // joints
  // Tip, Jacobian and inertia, and the torques that the joints need for the motion that they are in
  // (LinkPart::kAll without accelerations).
  const LinkAnswer* arm = nullptr;
  const double* wanted = nullptr;    // accelerations that the joints shall have
  const double* velocity = nullptr;  // of the joints
  const LeafSprings* springs = nullptr;
  // For the torques: where the leaf shall be; what it is pushed with on top, 6; the share of the
  // damping.
  LeafGoal goal;
  const double* feedforward = nullptr;
  double damping_ratio = 1;
};

struct LeafAnswer {
  // Acts against the velocity of the leaf so that no motion overshoots, whatever mass the leaf
  // shows: in coordinates in which all springs are alike it is twice the root of the mass. Off by
  // less than 1e-4 of that, and never pushing.
  double damping[6];
  // The force that would accelerate the leaf as the wanted accelerations do.
  double felt[6];
  // Of the joints: what they need to accelerate as wanted, and what pushes the leaf with
  // stiffness * way to the goal - damping_ratio * damping + feedforward - felt.
  alignas(64) LinkTable::Row torques;
};

void ComputeLeaf(const LeafQuery& query, LeafAnswer* out);

// A part alone: how far the leaf is from its goal, the way and the rotation vector of the rest, 6.
void ComputeDeviation(const LinkAnswer& arm, const LeafGoal& goal, double* deviation);
// A part alone: what the leaf yields to a force (J M^-1 J^T), the lower triangle row by
// row.
void ComputeMobility(int n, const LinkAnswer& arm, double* mobility);
// The last part alone: the critical damping of a leaf of that mobility.
void CriticalDamping(const double* stiffness, const double* mobility, const double* velocity,
                     double* out);

// Where the leaf cannot be moved it seems to be infinitely heavy; this bounds it, 1/kg.
inline constexpr double kLeastMobility = 1e-6;

}  // namespace robocell
