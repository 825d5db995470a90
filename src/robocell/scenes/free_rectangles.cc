#include "robocell/scenes/free_rectangles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace robocell::internal {

std::optional<CellRectangle> TakeLargest(std::vector<bool>& taken, int nx, int ny, int least) {
  const auto index = [nx](int i, int j) {
    return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i);
  };
  // The classic sweep: per row the heights of free columns, and the largest rectangle under them.
  std::vector<int> heights(static_cast<size_t>(nx), 0);
  CellRectangle best;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      int& height = heights[static_cast<size_t>(i)];
      height = taken[index(i, j)] ? 0 : height + 1;
    }
    std::vector<int> open;  // open columns, in order of increasing height
    for (int i = 0; i <= nx; ++i) {
      const int height = i < nx ? heights[static_cast<size_t>(i)] : 0;
      while (!open.empty() && heights[static_cast<size_t>(open.back())] >= height) {
        const int top = heights[static_cast<size_t>(open.back())];
        open.pop_back();
        const int first = open.empty() ? 0 : open.back() + 1;
        const int width = i - first;
        if (std::min(width, top) >= least &&
            int64_t{width} * top > int64_t{best.width} * best.height)
          best = {.i = first, .j = j - top + 1, .width = width, .height = top};
      }
      open.push_back(i);
    }
  }
  if (best.width == 0) return std::nullopt;
  for (int i = best.i; i < best.i + best.width; ++i) {
    for (int j = best.j; j < best.j + best.height; ++j) taken[index(i, j)] = true;
  }
  return best;
}

std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  const auto add = [&](const Eigen::Vector2d& point, size_t least) {
    while (hull.size() >= least && turn(hull[hull.size() - 2], hull.back(), point) <= 0)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const Eigen::Vector2d& point : points) add(point, 2);
  const size_t lower = hull.size() + 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) add(*point, lower);
  hull.pop_back();
  return hull;
}

}  // namespace robocell::internal
