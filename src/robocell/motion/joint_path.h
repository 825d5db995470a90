// Paths in joint space that keep free of obstacles: straight lines, and a tree search when those
// fail. Knows nothing of robots: what is free is asked from the caller.
//
//   std::optional<JointPath> path = ConnectTrees(start, goal, limits, is_free, rng);
//
// Distances are the largest difference of any joint (rad; m for slides). Edges are looked at in
// steps, so obstacles thinner than a step may be missed: ask for clearance. Same inputs and same
// Rng state, same path.
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

// The largest difference of any joint.
double JointDistance(const JointVector& a, const JointVector& b);
JointVector Blend(const JointVector& a, const JointVector& b, double part);

// Whether the whole straight line from a to b is collision-free; a itself is not checked.
bool EdgeIsFree(const JointVector& a, const JointVector& b, const FreeFunction& is_free,
                double step = kEdgeStep);

struct TreeOptions {
  int iterations = 300;
  double step = 0.3;    // of a tree's growth
  double beyond = 1.0;  // how far around the box spanned by both ends is searched, per joint
  int shortcuts = 30;   // tries
};

// RRT-connect (J. Kuffner and S. LaValle, 2000) with short cuts. Both ends must be free. Unset when
// none was found.
std::optional<JointPath> ConnectTrees(const JointVector& start, const JointVector& goal,
                                      const std::vector<Interval>& limits,
                                      const FreeFunction& is_free, Rng& rng,
                                      const TreeOptions& options = {});

}  // namespace robocell
