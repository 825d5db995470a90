// Rectangles of free cells in a grid, and the outline of points. Private to scenes.
#pragma once

#include <optional>
#include <vector>
#include <Eigen/Core>

namespace robocell::internal {

struct CellRectangle {
  int i = 0, j = 0;  // its first column and row
  int width = 0, height = 0;
};

// Returns the largest rectangle of free cells, at least `least` cells long and wide, and marks it
// as taken; unset if there is none. `taken` has nx columns and ny rows: cell (i, j) is
// taken[j * nx + i].
std::optional<CellRectangle> TakeLargest(std::vector<bool>& taken, int nx, int ny, int least);

// Returns the convex hull counter-clockwise (Andrew 1979).
std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> points);

}  // namespace robocell::internal
