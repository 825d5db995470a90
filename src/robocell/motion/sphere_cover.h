// Spheres that cover a convex body, in a tree from coarse to fine.
//
// Every point of the body is inside a leaf, and no leaf reaches farther than `inflation` out of the
// body: both hold by construction, not by chance. The body is cut into small cells; a cell counts
// as covered when a leaf contains the ball around it. Leaves are chosen greedily, each the one that
// covers most of what is left. An inner sphere contains all leaves below it.
//
//   const SphereCover cover = CoverWithSpheres(shape, 0.01);
#pragma once

#include <vector>
#include <Eigen/Core>

#include "robocell/motion/convex_shape.h"

namespace robocell::internal {

struct SphereCover {
  struct Node {
    Eigen::Vector3d centre;  // in the frame of the shape
    double radius = 0;
    int next = 0;  // the node after this one's subtree
  };
  // Depth first: the root, its first child and what is below it, ...
  std::vector<Node> nodes{};
  double inflation = 0;  // m, the bound that holds

  bool is_leaf(int node) const { return nodes[node].next == node + 1; }
  int leaves() const;
};

// The body must be bounded; `inflation` in m, above 0. Large bodies get a larger one, so that their
// covers stay small.
SphereCover CoverWithSpheres(const ConvexShape& shape, double inflation);

// Returns the inflation that suits a body: a share of its size, within bounds in which covers have
// a few hundred spheres for an arm.
double InflationFor(const ConvexShape& shape);

}  // namespace robocell::internal
