#include "robocell/kinematics/reach_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/on_threads.h"

namespace robocell {
namespace {

// Poses that are solved together: enough for all threads, few enough for the caches.
constexpr int kPosesTogether = 1 << 15;
// Of a cell, whose poses are solved together.
constexpr int kMostRotations = 100'000;

void Refuse(const std::string& what) { throw ArgumentError("reach map: " + what); }

// Cells along an axis, and the centre of the first.
std::pair<double, double> Divide(double lower, double upper, double cell) {
  const double count = std::max(1.0, std::ceil((upper - lower) / cell - 1e-9));
  return {count, 0.5 * (lower + upper - (count - 1) * cell)};
}

void CheckReachMap(const ReachGrid& grid, const ReachMapOptions& options) {
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

class Mapper {
 public:
  Mapper(const Chain& chain, const ReachMapOptions& options, ReachMap* map)
      : chain_(chain), map_(*map) {
    batch_.ik.position_only = options.position_only;
    batch_.ik.axis = options.axis;
    batch_.ik.tolerance = options.tolerance;
    batch_.ik.max_restarts = options.max_restarts;
    batch_.threads = options.threads;
    batch_.poll = options.poll;
    for (int k = 0; k < map->rotations; ++k)
      rotations_.push_back(SpreadRotation(k, map->rotations));
  }

  void Run() {
    const std::size_t together = std::max<std::size_t>(1, kPosesTogether / rotations_.size());
    for (int x = 0; x < map_.cells[0]; ++x) {
      for (int y = 0; y < map_.cells[1]; ++y) {
        for (int z = 0; z < map_.cells[2]; ++z) {
          Add(map_.index(x, y, z), map_.centre(x, y, z));
          if (asked_.size() >= together) Solve();
        }
      }
    }
    Solve();
  }

 private:
  void Add(std::size_t cell, const Eigen::Vector3d& centre) {
    const ChainModel& model = chain_.model();
    const double away = (centre - model.joints[0].fixed.translation).norm();
    if (away > model.reach_bound + batch_.ik.tolerance) return;
    asked_.push_back(cell);
    for (const Quaternion& turn : rotations_) targets_.emplace_back(centre, turn);
  }

  void Solve() {
    IkBatch(chain_, targets_, {}, batch_, &found_);
    const int cells = static_cast<int>(asked_.size());
    const int threads = std::clamp(batch_.threads, 1, std::max(1, cells));
    manipulability_.resize(targets_.size());
    OnThreads(threads, [&](int t) {
      for (int k = t; k < cells; k += threads) Fill(k);
    });
    asked_.clear();
    targets_.clear();
  }

  // The k-th of the cells that were asked for.
  void Fill(int k) {
    const int count = static_cast<int>(rotations_.size());
    const std::size_t first = static_cast<std::size_t>(k) * count, n = chain_.n_joints();
    const auto solved = std::span(found_.success).subspan(first, count);
    const auto reached = std::count(solved.begin(), solved.end(), uint8_t{1});
    map_.fraction[asked_[k]] = static_cast<float>(reached) / static_cast<float>(count);
    if (reached == 0) return;
    // Of all, for the lanes; those of approaches are not looked at.
    const auto values = std::span(manipulability_).subspan(first, count);
    ManipulabilityBatch(chain_, std::span(found_.q).subspan(first * n, count * n), values);
    double sum = 0;
    for (int b = 0; b < count; ++b) sum += solved[b] ? values[b] : 0;
    map_.manipulability[asked_[k]] = static_cast<float>(sum / static_cast<double>(reached));
  }

  const Chain& chain_;
  ReachMap& map_;
  IkBatchOptions batch_;
  std::vector<Quaternion> rotations_;
  std::vector<std::size_t> asked_;
  std::vector<Pose> targets_;
  IkBatchResult found_;
  std::vector<double> manipulability_;
};

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
  CheckReachMap(grid, options);
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
  Mapper(chain, options, &map).Run();
  return map;
}

}  // namespace robocell
