#include "robocell/motion/convex_shape.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robocell/motion/testing/shapes.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

double DepthInAny(const std::vector<ConvexShape>& shapes, const Eigen::Vector3d& point) {
  double deepest = -1e9;
  for (const ConvexShape& shape : shapes) deepest = std::max(deepest, Depth(shape, point));
  return deepest;
}

TEST(ConvexShape, ContainsThePointsThatRaysFindOnEveryKindOfGeom) {
  const ShapesModel shapes;
  Rng rng = Rng::Stream(1, "rays");
  for (int g = 0; g < shapes.model()->ngeom; ++g) {
    const std::vector<ConvexShape> bodies = ConvexShapesOf(shapes.model(), g);
    for (const Eigen::Vector3d& point : shapes.SurfacePoints(g, 400, rng))
      EXPECT_GT(DepthInAny(bodies, point), -1e-6) << shapes.Name(g);
  }
}

TEST(ConvexShape, IsHardlyLargerThanTheGeom) {
  const ShapesModel shapes;
  Rng rng = Rng::Stream(2, "rays");
  for (const std::string name : {"ball", "capsule", "box", "cylinder", "ellipsoid", "mesh"}) {
    const int g = shapes.Geom(name);
    for (const ConvexShape& shape : ConvexShapesOf(shapes.model(), g)) {
      for (const Eigen::Vector3d& point : shapes.SurfacePoints(g, 200, rng))
        EXPECT_LT(Depth(shape, point), 0.002) << name;  // of bodies of 10 cm
    }
  }
}

TEST(ConvexShape, FewerPlanesOnlyMakeAMeshLarger) {
  const ShapesModel shapes;
  Rng rng = Rng::Stream(3, "rays");
  const int g = shapes.Geom("mesh");
  const std::vector<ConvexShape> few = ConvexShapesOf(shapes.model(), g, 40);
  EXPECT_LE(few[0].planes.size(), 40u);
  for (const Eigen::Vector3d& point : shapes.SurfacePoints(g, 300, rng)) {
    EXPECT_GT(Depth(few[0], point), -1e-6);
    EXPECT_LT(Depth(few[0], point), 0.02);
  }
}

TEST(ConvexShape, ApproachBringsAPointNearerToAllPointsOfTheBody) {
  const ShapesModel shapes;
  Rng rng = Rng::Stream(4, "points");
  for (const std::string name : {"capsule", "box", "cylinder", "mesh"}) {
    const int g = shapes.Geom(name);
    const ConvexShape shape = ConvexShapesOf(shapes.model(), g)[0];
    const std::vector<Eigen::Vector3d> surface = shapes.SurfacePoints(g, 50, rng);
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d point = RandomVector(rng, 0.2), moved = Approach(shape, point);
      if (Depth(shape, point) >= 0) {
        EXPECT_EQ(moved, point);
      }
      EXPECT_GT(Depth(shape, moved), -2e-3);
      for (const Eigen::Vector3d& of : surface)
        EXPECT_LE((moved - of).norm(), (point - of).norm() + 1e-9) << name;
    }
  }
}

}  // namespace
}  // namespace robocell::internal
