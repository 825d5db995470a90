#include "robocell/motion/sphere_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

// A part of the body: everything within `radius` of `at`.
struct Cell {
  Vector3d at;
  double radius;
};
struct Sphere {
  Vector3d centre;
  double radius;
};

constexpr double kFinestCell = 0.4;  // radius of cells at the surface, as a share of the inflation
constexpr double kDeeperCell = 0.5;  // cells grow by this share of their depth
constexpr int kTries = 24;           // cells that propose the next sphere
constexpr size_t kCounted = 1000;    // cells, at most, by which proposals are compared
constexpr int kHalvings = 8;
constexpr double kShares[] = {0.35, 0.6, 0.8, 1};  // of the deepest centre that covers a cell
constexpr int kOfACluster = 6;                     // leaves below one inner sphere
constexpr int kMostCells = 12'000;

// Cuts the box into cells until each can be covered. Points of the body in a cell are within
// `half`'s length of its centre, and stay so when the centre approaches the body.
void Cut(const ConvexShape& shape, const Vector3d& centre, const Vector3d& half, double inflation,
         std::vector<Cell>* cells) {
  const double radius = half.norm(), depth = Depth(shape, centre);
  if (depth < -radius) return;
  if (radius <= kFinestCell * inflation + kDeeperCell * std::max(0.0, depth)) {
    cells->push_back({depth < 0 ? Approach(shape, centre) : centre, radius});
    return;
  }
  // Halves long sides only.
  const double longest = half.maxCoeff();
  std::array<int, 3> parts;
  for (int i = 0; i < 3; ++i) parts[i] = half[i] > 0.6 * longest ? 2 : 1;
  const Vector3d part(half.x() / parts[0], half.y() / parts[1], half.z() / parts[2]);
  for (int x = 0; x < parts[0]; ++x) {
    for (int y = 0; y < parts[1]; ++y) {
      for (int z = 0; z < parts[2]; ++z) {
        const Vector3d at =
            centre - half + part.cwiseProduct(Vector3d(2 * x + 1, 2 * y + 1, 2 * z + 1));
        Cut(shape, at, part, inflation, cells);
      }
    }
  }
}

Sphere Around(const ConvexShape& shape, const Vector3d& centre, double inflation) {
  return {centre, std::max(0.0, Depth(shape, centre)) + inflation};
}

bool Covers(const Sphere& sphere, const Cell& cell) {
  const double room = sphere.radius - cell.radius;
  return room >= 0 && (sphere.centre - cell.at).squaredNorm() <= room * room;
}

// Calls visit(sphere) for spheres that cover the cell and reach into the body: their centres lie on
// the way inwards from its surface, as deep as they can be, and in between.
template <class Visit>
void VisitSpheres(const ConvexShape& shape, const Cell& cell, double inflation, Visit&& visit) {
  const double near = Depth(shape, cell.at) + inflation;
  Vector3d inwards = Vector3d::Zero();
  for (const HalfSpace& plane : shape.planes) {
    const double depth = plane.offset - plane.normal.dot(cell.at);
    if (depth < near) inwards -= (1.01 - depth / near) * plane.normal;
  }
  visit(Around(shape, cell.at, inflation));
  if (inwards.norm() < 1e-9) return;
  inwards.normalize();
  double low = 0, high = shape.box.diagonal().norm() / 2;
  for (int k = 0; k < kHalvings; ++k) {  // the set of depths that cover it is an interval from 0
    const double depth = (low + high) / 2;
    const Sphere sphere = Around(shape, cell.at + depth * inwards, inflation);
    (sphere.radius > inflation && Covers(sphere, cell) ? low : high) = depth;
  }
  for (const double share : kShares) {
    const Sphere sphere = Around(shape, cell.at + share * low * inwards, inflation);
    if (Covers(sphere, cell)) visit(sphere);
  }
}

std::vector<Sphere> Choose(const ConvexShape& shape, std::vector<Cell> cells, double inflation) {
  std::vector<Sphere> chosen;
  while (!cells.empty()) {
    const auto every = [&](size_t most) { return std::max<size_t>(1, cells.size() / most); };
    const size_t step = every(kTries), stride = every(kCounted);
    Sphere best{};
    int most = -1;
    for (size_t i = 0; i < cells.size(); i += step) {
      VisitSpheres(shape, cells[i], inflation, [&](const Sphere& sphere) {
        int covered = 0;
        for (size_t k = i % stride; k < cells.size(); k += stride)
          covered += Covers(sphere, cells[k]);
        if (covered > most) most = covered, best = sphere;
      });
    }
    chosen.push_back(best);
    const auto is_covered = [&](const Cell& cell) { return Covers(best, cell); };
    if (std::erase_if(cells, is_covered) > 0) continue;
    // Rounding: the cell gets a sphere of its own.
    chosen.back() = {cells.back().at, cells.back().radius};
    cells.pop_back();
  }
  return chosen;
}

// Returns a small sphere around others (M. Badoiu and K. Clarkson, "Smaller core-sets for balls",
// 2003).
Sphere AroundAll(std::span<const Sphere> spheres) {
  Vector3d centre = Vector3d::Zero();
  for (const Sphere& s : spheres) centre += s.centre / static_cast<double>(spheres.size());
  double radius = std::numeric_limits<double>::infinity();
  Vector3d best = centre;
  for (int k = 0; k < 40; ++k) {
    const auto reach = [&](const Sphere& s) { return (s.centre - centre).norm() + s.radius; };
    const Sphere& farthest = *std::ranges::max_element(spheres, {}, reach);
    if (reach(farthest) < radius) radius = reach(farthest), best = centre;
    const Vector3d towards = farthest.centre - centre;
    if (towards.norm() < 1e-12) break;
    centre += (towards + towards.normalized() * farthest.radius) / (k + 2);
  }
  return {best, radius};
}

void Build(std::span<Sphere> spheres, std::vector<SphereCover::Node>* nodes) {
  const size_t at = nodes->size();
  const Sphere all = spheres.size() == 1 ? spheres[0] : AroundAll(spheres);
  nodes->push_back({all.centre, all.radius, 0});
  const auto end = [&] { (*nodes)[at].next = static_cast<int>(nodes->size()); };
  if (spheres.size() == 1) return end();
  if (spheres.size() <= kOfACluster) {
    for (const Sphere& s : spheres) {
      nodes->push_back({s.centre, s.radius, 0});
      nodes->back().next = static_cast<int>(nodes->size());
    }
    return end();
  }
  // Four parts, by two cuts across the longest sides.
  const auto cut = [](std::span<Sphere> part) {
    Eigen::AlignedBox3d box;
    for (const Sphere& s : part) box.extend(s.centre);
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const size_t middle = part.size() / 2;
    std::nth_element(
        part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
        [axis](const Sphere& a, const Sphere& b) { return a.centre[axis] < b.centre[axis]; });
    return std::array{part.first(middle), part.subspan(middle)};
  };
  for (const std::span<Sphere> half : cut(spheres)) {
    if (half.size() <= kOfACluster) {
      Build(half, nodes);
      continue;
    }
    for (const std::span<Sphere> quarter : cut(half)) Build(quarter, nodes);
  }
  end();
}

}  // namespace

int SphereCover::leaves() const {
  int count = 0;
  for (int k = 0; k < static_cast<int>(nodes.size()); ++k) count += is_leaf(k);
  return count;
}

SphereCover CoverWithSpheres(const ConvexShape& shape, double inflation) {
  std::vector<Sphere> spheres;
  if (shape.kind == ConvexShape::Kind::kSweptBall) {
    // Balls of the swept radius and the inflation: neighbours meet where the sweep's surface ends.
    const double radius = shape.radius + inflation;
    const double reach = std::sqrt(radius * radius - shape.radius * shape.radius);
    const int parts = static_cast<int>(std::ceil(shape.half_length / reach));
    if (parts == 0) spheres.push_back({Vector3d::Zero(), shape.radius});
    for (int k = 0; parts > 0 && k <= parts; ++k)
      spheres.push_back({{0, 0, shape.half_length * (2.0 * k / parts - 1)}, radius});
  } else {
    const Vector3d half = shape.box.sizes() / 2;
    // Large bodies have larger cells, so that their covers stay small.
    std::vector<Cell> cells;
    const double area = 8 * (half.x() * half.y() + half.y() * half.z() + half.z() * half.x());
    inflation = std::max(inflation, std::sqrt(3 * area / kMostCells) / (2 * kFinestCell));
    Cut(shape, shape.box.center(), half, inflation, &cells);
    spheres = Choose(shape, std::move(cells), inflation);
  }
  const bool is_ball = shape.kind == ConvexShape::Kind::kSweptBall && shape.half_length == 0;
  SphereCover cover{.inflation = is_ball ? 0 : inflation};
  Build(spheres, &cover.nodes);
  return cover;
}

double InflationFor(const ConvexShape& shape) {
  return std::clamp(0.1 * shape.box.sizes().maxCoeff(), 0.004, 0.01);
}

}  // namespace robocell::internal
