// Proof of grasps by simulation: the hand alone closes on the object without gravity and shakes it to
// six sides. What is still between the fingers, where it was, is held.
//
//   const std::vector<GraspProof> proofs = ProveGrasps(robot, grasps);
//   GraspSet proven = KeepProven(grasps, proofs);
//
// The object and the robot get a scene of their own, in which the arm cannot move: shaking is gravity
// that changes its direction. Only grasps of objects of the scene that move freely can be proven.
#pragma once

#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"

namespace robocell {

struct ShakeOptions {
  double acceleration = 10;  // m/s^2, in six directions one after the other: about gravity
  double seconds = 0.2;      // in each direction
  double most_slip = 0.02;   // m that the object may move in the hand while it is shaken
  double most_turn = 0.5;    // rad that it may turn
};

struct GraspProof {
  bool held = false;
  std::string failure = {};   // "the hand closed on nothing", "the object slipped by 0.05 m"
  double slip = 0, turn = 0;  // m, rad
};

// Returns a proof for each grasp of the set. Throws ArgumentError for a body that is not a free
// object of the scene, for pushes and hooks, which hold nothing, and for options out of range.
std::vector<GraspProof> ProveGrasps(const Robot& robot, const GraspSet& grasps,
                                    const ShakeOptions& options = {});

// Returns the grasps that are held, in the same order.
GraspSet KeepProven(const GraspSet& grasps, const std::vector<GraspProof>& proofs);

}  // namespace robocell
