// One damped least-squares step for many inverse kinematics queries at once: every lane of a vector
// register works on its own query, with the widest registers of this processor.
//
// Lanes never mix: each lane depends on its own numbers alone, so that a result does not depend on
// its neighbours. Other instruction sets round differently.
//
// Plain numbers only; this header is included by code for every instruction set. Lengths are in
// units of the chain's `length` (FoldedChain).
#pragma once

#include <cstdint>

#include "robocell/kinematics/folded_chain.h"

namespace robocell::internal {

// The most lanes that any instruction set uses.
inline constexpr int kMaxLanes = 16;

// The state of the lanes, one column per lane. It is not initialised: clearing all of it would take
// a tenth of the time of an easy query. Lanes that are stepped beside others must have values.
struct LaneState {
  alignas(64) double q[kMaxChainJoints][kMaxLanes];
  // Distance by which hinges with limits of a full turn may exceed them: 0 or infinity. Solutions
  // beyond the limits differ by whole turns.
  alignas(64) double roam[kMaxLanes];
  // Target of the last screw's frame, in the frame of the first: x, y and z axis; and target of the
  // tip.
  alignas(64) double axes[9][kMaxLanes];
  alignas(64) double position[3][kMaxLanes];
  // Errors of the q before the step: squared distance of the tip, and squared 2 tan(angle / 2) of
  // the remaining rotation, which is never less than the angle.
  alignas(64) double distance2[kMaxLanes];
  alignas(64) double turn2[kMaxLanes];
  // The q with the least sum of both since the cost was last set to infinity.
  alignas(64) double best_cost[kMaxLanes];
  alignas(64) double best_q[kMaxChainJoints][kMaxLanes];
};

struct LaneOptions {
  double distance2 = 0, turn2 = 0;  // a lane with neither above has arrived
  bool locked[kMaxChainJoints] = {};
};

// Inputs of queries with axes, cones or weights. The rows then define the pose error: distance2 and
// turn2 are those of the rows.
struct LaneTask {
  // If true, only this axis of the rotation, in the frame of the last screw, must agree with the
  // target's axis, up to an angle; this is tan(angle / 2).
  bool swing = false;
  double axis[3] = {};
  double cone = 0;
  // 1 if the step goes to the axis itself, so that a narrow cone is reached like an axis; 0 if it
  // goes only to the border of the cone. In both cases the lane arrives in the cone.
  alignas(64) double to_axis[kMaxLanes] = {};
  // Joints take part in a step in proportion to this.
  double share[kMaxChainJoints] = {};
  // The part of the distance to its goal that a redundant joint moves in a step. The other joints
  // compensate in proportion to `ease`, which compares a radian with a length.
  double part[kMaxChainJoints] = {}, ease[kMaxChainJoints] = {};

  // Three rows each of the remaining translation and rotation; one column per lane.
  alignas(64) double linear[9][kMaxLanes] = {};
  alignas(64) double angular[9][kMaxLanes] = {};
  alignas(64) double goal[kMaxChainJoints][kMaxLanes] = {};
  // 1 if redundant joints go to the goal, also after arrival; else 0.
  alignas(64) double pull[kMaxLanes] = {};
};

// Lanes of this processor's kernel: a multiple of its registers' width, at most kMaxLanes.
int LaneCount();
// The lanes below this number are for one query: stepping some of them costs as much as all, and
// less than a group of all lanes. Lane 0 alone, without a task, costs even less.
int LanesOfOneQuery();

// Measures the busy lanes (bits), and moves those that have not arrived one step. Returns the lanes
// that have arrived; bits of others have no meaning. Without a task the query is a pose.
uint32_t StepLanes(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                   LaneState* state, const LaneTask* task = nullptr);

}  // namespace robocell::internal
