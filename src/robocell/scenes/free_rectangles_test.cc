#include "robocell/scenes/free_rectangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "robocell/base/rng.h"

namespace robocell::internal {
namespace {

// Tries all rectangles.
int LargestByTrying(const std::vector<bool>& taken, int nx, int ny, int least) {
  int best = 0;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      for (int w = least; i + w <= nx; ++w) {
        for (int h = least; j + h <= ny; ++h) {
          bool free = true;
          for (int k = i; k < i + w; ++k) {
            for (int l = j; l < j + h; ++l) free &= !taken[static_cast<size_t>(l * nx + k)];
          }
          if (free) best = std::max(best, w * h);
        }
      }
    }
  }
  return best;
}

TEST(FreeRectangles, AreTheLargestOnes) {
  Rng rng = Rng::Stream(1, "grids");
  for (int trial = 0; trial < 60; ++trial) {
    const int nx = 3 + static_cast<int>(rng.UniformInt(6)),
              ny = 3 + static_cast<int>(rng.UniformInt(6));
    std::vector<bool> taken(static_cast<size_t>(nx * ny));
    for (auto&& cell : taken) cell = rng.Uniform(0, 1) < 0.3;
    const std::vector<bool> before = taken;
    const int best = LargestByTrying(taken, nx, ny, 2);
    const std::optional<CellRectangle> found = TakeLargest(taken, nx, ny, 2);
    ASSERT_EQ(found ? found->width * found->height : 0, best);
    if (!found) continue;
    int marked = 0;
    for (size_t cell = 0; cell < taken.size(); ++cell) marked += taken[cell] != before[cell];
    EXPECT_EQ(marked, best);
  }
}

TEST(FreeRectangles, HullsGoAroundTheirPointsCounterClockwise) {
  Rng rng = Rng::Stream(2, "points");
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(rng.Uniform(-1, 1), rng.Uniform(-1, 1));
  const std::vector<Eigen::Vector2d> hull = ConvexHull(points);
  ASSERT_GE(hull.size(), 3U);
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    for (const Eigen::Vector2d& point : points) {
      const Eigen::Vector2d to = point - hull[i];
      EXPECT_GE(edge.x() * to.y() - edge.y() * to.x(), -1e-12);
    }
  }
}

}  // namespace
}  // namespace robocell::internal
