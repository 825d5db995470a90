// Jacobian, mass matrix and torques of one configuration: every lane of a vector register works on
// its own link, with the widest registers of this processor, of AVX2 at most.
//
// Only the frames depend on each other. Everything else is sums of the links' contributions along
// the chain: all in the axes of the base and about one origin, so that nothing has to be
// transformed from link to link (Newton-Euler and composite bodies as in R. Featherstone, "Rigid
// Body Dynamics Algorithms", 2008, chapters 5 and 6). Instruction sets round differently.
//
// Plain numbers only; this header is included by code for every instruction set.
#pragma once

#include "robocell/kinematics/link_table.h"

namespace robocell::internal {

// Joint values, n each; gravity in the base frame. Only those that the requested part needs.
struct LinkQuery {
  const double* q = nullptr;
  const double* qd = nullptr;
  const double* qdd = nullptr;  // null: no acceleration
  const double* gravity = nullptr;
};

// The requested results; the others are not written. Entries from n on have no meaning.
struct LinkAnswer {
  // x, y, z axis and position of the tip in the base frame; the fourth number is 0.
  alignas(64) double tip[4][4];
  alignas(64) LinkTable::Row jacobian[6];  // linear rows first
  alignas(64) LinkTable::Row mass[kMaxChainJoints];
  alignas(64) LinkTable::Row torques;
};

enum class LinkPart {
  kTip,
  kJacobian,  // and tip
  kMass,
  kGravity,  // torques against gravity
  kMotion,   // torques for qd and qdd, against gravity
  kAll       // tip, Jacobian, the lower triangle of the mass, and the torques of kMotion
};

void ComputeLinks(const LinkTable& table, LinkPart part, const LinkQuery& query, LinkAnswer* out);

}  // namespace robocell::internal
