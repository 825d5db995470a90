// Collision-free paths in joint space: straight lines, and a tree search if these fail. It knows
// nothing of robots: the caller's function decides which configurations are free.
//
//   std::optional<JointPath> path = ConnectTrees(start, goal, limits, is_free, rng);
//
// Distances are the largest difference of any joint (rad; m for slides). Edges are checked in
// steps, so obstacles thinner than a step may be missed: require a clearance. The same inputs and
// Rng state give the same path.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/kinematics/joint_vector.h"
#include "robocell/robot/move_group.h"

namespace robocell {

using JointPath = std::vector<JointVector>;
using FreeFunction = std::function<bool(const JointVector&)>;

inline constexpr double kEdgeStep = 0.06;

// Returns the largest difference of any joint.
double JointDistance(const JointVector& a, const JointVector& b);
JointVector Blend(const JointVector& a, const JointVector& b, double part);

// Returns true if the whole straight line from a to b is collision-free; a itself is not checked.
bool EdgeIsFree(const JointVector& a, const JointVector& b, const FreeFunction& is_free,
                double step = kEdgeStep);

struct TreeOptions {
  int iterations = 300;
  double step = 0.3;    // growth step of a tree
  double beyond = 1.0;  // margin of the search around the box spanned by both ends, per joint
  int shortcuts = 30;   // tries
};

// Runs RRT-connect (J. Kuffner and S. LaValle, 2000) with short cuts. Both ends must be free. Unset
// if it found no path.
std::optional<JointPath> ConnectTrees(const JointVector& start, const JointVector& goal,
                                      const std::vector<Interval>& limits,
                                      const FreeFunction& is_free, Rng& rng,
                                      const TreeOptions& options = {});

}  // namespace robocell
