#include "robocell/motion/cover_cache.h"

#include <gtest/gtest.h>

#include "robocell/motion/testing/shapes.h"

namespace robocell::internal {
namespace {

TEST(CachedCover, IsMadeOnceForEachShape) {
  const ShapesModel shapes;
  const ConvexShape box = ConvexShapesOf(shapes.model(), shapes.Geom("box"))[0];
  ConvexShape other = box;
  other.planes[0].offset += 1e-3;
  EXPECT_EQ(CachedCover(box), CachedCover(box));
  EXPECT_NE(CachedCover(box), CachedCover(other));
}

}  // namespace
}  // namespace robocell::internal
