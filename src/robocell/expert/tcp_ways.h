// Ways of an arm's joints that move its TCP through given poses: one for each branch of postures that
// goes through, such as elbow up and elbow down. The surroundings play no part.
//
//   for (const JointPath& way : TcpWays(arm, poses, seed, {.anchors = {9, 80}}, rng)) ...
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/motion/joint_path.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

struct TcpWayOptions {
  // Indices of poses at which postures are drawn; from there the way goes both ways. At least one.
  std::vector<size_t> anchors = {0};
  int draws = 4;            // postures at each of them, beside the one nearest to `seed`
  size_t most = 3;          // ways that are returned
  double jump = 0.25;       // rad or m of a joint between two poses, at most
  double tolerance = 1e-4;  // of inverse kinematics, m and rad
};

// Returns ways with one posture for each of the poses, which are in the world and so near to each other
// that the postures are too. Those that begin near `seed` come first. Empty if the arm cannot follow.
std::vector<JointPath> TcpWays(const Robot& arm, std::span<const Pose> tcps,
                               const JointVector& seed, const TcpWayOptions& options, Rng& rng);

}  // namespace robocell::internal
