// SphereTable: everything that a check of many configurations needs, as plain numbers: moving
// links with their trees of spheres, obstacles, and the pairs that may collide.
//
// Coordinates are floats of the world or of a link, metres. collision_model.h makes a table;
// sphere_kernel.h reads it. This header is included by code for every instruction set.
#pragma once

#include <cstdint>
#include <vector>

namespace robocell::internal {

// Configurations that are checked at once.
inline constexpr int kLanes = 8;

struct SphereTable {
  struct Ball {
    float x = 0, y = 0, z = 0, radius = -1;  // below 0: nothing
  };
  struct Range {
    int32_t first = 0, last = 0;
  };
  struct Link {
    int32_t parent = 0;
    bool slide = false, follows = false;
    int32_t dof = 0;
    double reference = 0;
    double from = 0, polynomial[5] = {0, 1, 0, 0, 0};
    float rotation[9] = {};  // row by row
    float translation[3] = {};
    Ball ball;    // around all trees of the link
    Range trees;  // of the link
    Range near;   // in `near`: obstacles that the link may reach
    Range pairs;  // in `link_pairs`: links before this one
  };
  // Spheres of one geom.
  struct Tree {
    Range nodes;
    int32_t link = 0;
    float shrink = 0;  // how much smaller its spheres are where `DemandOfSpheres::shrunk` counts, m
    int32_t geom = -1;
    bool own = false;  // part of the robot: obstacles of its own may be nearer
  };
  struct Node {
    Ball ball;
    int32_t next = 0;  // the node after this one's subtree
  };
  struct LinkPair {
    int32_t other = 0;
    Range trees;  // in `tree_pairs`
  };
  struct TreePair {
    int32_t tree = 0, other = 0;
    bool own = false;  // both are the robot's
  };
  enum class Shape : int32_t { kBall, kBox, kCapsule, kCylinder, kPolytope, kHalfSpace };
  struct Obstacle {
    Shape shape = Shape::kBall;
    float centre[3] = {};
    float axes[9] = {};  // x, y, z axis in the world
    float size[3] = {};  // of the engine's geoms
    Ball ball;           // around it; radius below 0 for half-spaces
    Range planes;
    int32_t geom = -1;
    bool own = false;  // part of the robot that does not move
  };
  struct Plane {
    float normal[3] = {};
    float offset = 0;
  };

  int32_t dofs = 0;
  std::vector<Link> links{};  // 0: what does not move
  std::vector<Tree> trees{};
  std::vector<Node> nodes{};
  std::vector<int32_t> near{};
  std::vector<LinkPair> link_pairs{};
  std::vector<TreePair> tree_pairs{};
  std::vector<Obstacle> obstacles{};
  std::vector<Plane> planes{};
  // 1 where a tree and an obstacle may touch; trees x obstacles.
  std::vector<uint8_t> ignored{};
};

}  // namespace robocell::internal
