// Maps where a chain's tip can be, and in how many rotations.
//
//   const ReachMap map = MapReach(chain, ReachGrid::Around(chain));
//   map.fraction[map.index(3, 4, 5)];  // of the rotations at this place, those that are reached
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "robocell/kinematics/chain.h"

namespace robocell {

// A box in the base frame, divided into cubes. If both corners agree along an axis there is one
// layer of cells, centred there.
struct ReachGrid {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  // m
  double cell = 0.05;  // edge of a cube, m

  // Returns a grid of everything that the chain may reach. Throws ArgumentError for a chain with
  // infinite reach.
  static ReachGrid Around(const Chain& chain, double cell = 0.05);
};

struct ReachMapOptions {
  // Rotations to try at the centre of each cell, spread evenly over all rotations.
  int rotations = 64;
  // The query at each cell, as in IkOptions. A chain of less than six joints reaches hardly any
  // exact rotation. With five joints, map the direction of an axis of the tip; with fewer, its
  // position only, for which `rotations` does not count.
  bool position_only = false;
  std::optional<Eigen::Vector3d> axis{};  // axis in the tip's frame
  double tolerance = 1e-3;                // m and rad
  // Starts after the first for each query. Solutions that these miss are found if the same rotation
  // was reached in an adjacent cell, whose joint values are then used as starts.
  int max_restarts = 4;
  int threads = 1;
  // Called occasionally on the caller's thread; its exception ends the map.
  std::function<void()> poll = {};
};

struct ReachMap {
  std::array<int, 3> cells{};                       // along x, y, z
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // centre of the first cell, m, base frame
  double cell = 0;                                  // distance between centres, m
  int rotations = 0;                                // tried at each cell
  // The share of reached rotations, 0 to 1; and the mean manipulability (manipulability.h) of the
  // configurations found, 0 without any. z changes fastest.
  std::vector<float> fraction{}, manipulability{};

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * cells[1] + y) * cells[2] + z;
  }
  // Returns the place of the cell with this index.
  std::array<int, 3> cell_at(std::size_t index) const {
    const auto at = static_cast<int64_t>(index);
    const int64_t column = at / cells[2];
    return {static_cast<int>(column / cells[1]), static_cast<int>(column % cells[1]),
            static_cast<int>(at % cells[2])};
  }
  Eigen::Vector3d centre(int x, int y, int z) const {
    return first + cell * Eigen::Vector3d(x, y, z);
  }
};

// Returns rotation k of `count`, spread evenly over all rotations on a super-Fibonacci spiral (M.
// Alexa, "Super-Fibonacci Spirals: Fast, Low-Discrepancy Sampling of SO(3)", 2022).
Quaternion SpreadRotation(int k, int count);

// Solves inverse kinematics for rotations times cells poses, about a million in some seconds on one
// core; limits are obeyed, collisions are ignored. The map is the same on any number of threads.
// Throws ArgumentError for corners that are not finite or in the wrong order, for a meaningless
// cell, tolerance or count, and for more than 2^31 poses.
ReachMap MapReach(const Chain& chain, const ReachGrid& grid, const ReachMapOptions& options = {});

}  // namespace robocell
