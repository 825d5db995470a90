#include "robocell/kinematics/reach_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/kinematics/reach_mapper.h"

namespace robocell {
namespace {

constexpr int kMostRotations = 100'000;

void Refuse(const std::string& what) { throw ArgumentError("reach map: " + what); }

// Returns the number of cells along an axis, and the centre of the first.
std::pair<double, double> Divide(double lower, double upper, double cell) {
  const double count = std::max(1.0, std::ceil((upper - lower) / cell - 1e-9));
  return {count, 0.5 * (lower + upper - (count - 1) * cell)};
}

void RequireReachMap(const ReachGrid& grid, const ReachMapOptions& options) {
  if (!grid.lower.allFinite() || !grid.upper.allFinite() ||
      (grid.lower.array() > grid.upper.array()).any()) {
    Refuse(fmt::format(
        "the corners are ({:g}, {:g}, {:g}) and ({:g}, {:g}, {:g}); they must be finite, and "
        "the first one the lower",
        grid.lower.x(), grid.lower.y(), grid.lower.z(), grid.upper.x(), grid.upper.y(),
        grid.upper.z()));
  }
  if (!(grid.cell > 0 && std::isfinite(grid.cell)))
    Refuse(fmt::format("cell is {} m; it must be more than 0", grid.cell));
  if (options.rotations < 1 || options.rotations > kMostRotations)
    Refuse(fmt::format("rotations is {}; it must be 1 to {}", options.rotations, kMostRotations));
}

}  // namespace

ReachGrid ReachGrid::Around(const Chain& chain, double cell) {
  const ChainModel& model = chain.model();
  if (!std::isfinite(model.reach_bound)) {
    throw ArgumentError("reach map of " + chain.description() +
                        ": a slide without limits reaches infinitely far; give the corners");
  }
  const Eigen::Vector3d& root = model.joints[0].fixed.translation;
  const Eigen::Vector3d far = Eigen::Vector3d::Constant(model.reach_bound);
  return {root - far, root + far, cell};
}

Quaternion SpreadRotation(int k, int count) {
  constexpr double kPhi = std::numbers::sqrt2, kPsi = 1.533751168755204288118041;
  const double s = k + 0.5, part = s / count;
  const double r = std::sqrt(part), big = std::sqrt(1 - part);
  const double alpha = 2 * std::numbers::pi * s / kPhi, beta = 2 * std::numbers::pi * s / kPsi;
  return {r * std::sin(alpha), r * std::cos(alpha), big * std::sin(beta), big * std::cos(beta)};
}

ReachMap MapReach(const Chain& chain, const ReachGrid& grid, const ReachMapOptions& options) {
  RequireReachMap(grid, options);
  ReachMap map{.cell = grid.cell, .rotations = options.position_only ? 1 : options.rotations};
  double poses = map.rotations;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [count, first] = Divide(grid.lower[axis], grid.upper[axis], grid.cell);
    poses *= count;
    if (poses > std::numeric_limits<int>::max()) {
      Refuse(
          fmt::format("more than 2^31 poses with cells of {:g} m and {} rotations; take larger "
                      "cells, fewer rotations or a smaller box",
                      grid.cell, map.rotations));
    }
    map.cells[axis] = static_cast<int>(count);
    map.first[axis] = first;
  }
  const std::size_t cells = map.index(map.cells[0] - 1, map.cells[1] - 1, map.cells[2] - 1) + 1;
  map.fraction.assign(cells, 0);
  map.manipulability.assign(cells, 0);
  internal::ReachMapper(chain, options, &map).Run();
  return map;
}

}  // namespace robocell
