#include "robocell/motion/sphere_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "robocell/motion/testing/shapes.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

// Returns the smallest distance from a point into a leaf; below 0 inside of one.
double OutsideOfLeaves(const SphereCover& cover, const Eigen::Vector3d& point) {
  double nearest = 1e9;
  for (size_t k = 0; k < cover.nodes.size(); ++k) {
    if (!cover.is_leaf(static_cast<int>(k))) continue;
    nearest = std::min(nearest, (cover.nodes[k].centre - point).norm() - cover.nodes[k].radius);
  }
  return nearest;
}

const std::vector<std::string> kBounded = {"ball",     "capsule",   "box",
                                           "cylinder", "ellipsoid", "mesh"};

TEST(SphereCover, CoversSurfaceAndInsideOfEveryKindOfGeom) {
  const ShapesModel shapes;
  Rng rng = Rng::Stream(1, "points");
  for (const std::string& name : kBounded) {
    const int g = shapes.Geom(name);
    const ConvexShape shape = ConvexShapesOf(shapes.model(), g)[0];
    for (const double inflation : {0.004, 0.01}) {
      const SphereCover cover = CoverWithSpheres(shape, inflation);
      for (const Eigen::Vector3d& point : shapes.SurfacePoints(g, 600, rng)) {
        ASSERT_LE(OutsideOfLeaves(cover, point), 1e-9) << name;
        ASSERT_LE(OutsideOfLeaves(cover, rng.Uniform() * point), 1e-9) << name;
      }
    }
  }
}

TEST(SphereCover, ReachesNoFartherThanItsInflation) {
  const ShapesModel shapes;
  for (const std::string& name : kBounded) {
    const ConvexShape shape = ConvexShapesOf(shapes.model(), shapes.Geom(name))[0];
    const SphereCover cover = CoverWithSpheres(shape, 0.01);
    EXPECT_LE(cover.inflation, 0.01) << name;
    for (size_t k = 0; k < cover.nodes.size(); ++k) {
      if (!cover.is_leaf(static_cast<int>(k))) continue;
      const SphereCover::Node& leaf = cover.nodes[k];
      EXPECT_LE(leaf.radius - Depth(shape, leaf.centre), cover.inflation + 2e-3) << name;
    }
  }
}

TEST(SphereCover, InnerSpheresContainTheLeavesBelowThem) {
  const ShapesModel shapes;
  for (const std::string& name : kBounded) {
    const SphereCover cover =
        CoverWithSpheres(ConvexShapesOf(shapes.model(), shapes.Geom(name))[0], 0.005);
    EXPECT_EQ(cover.nodes[0].next, static_cast<int>(cover.nodes.size())) << name;
    for (int k = 0; k < static_cast<int>(cover.nodes.size()); ++k) {
      const SphereCover::Node& node = cover.nodes[k];
      for (int below = k + 1; below < node.next; ++below) {
        const SphereCover::Node& other = cover.nodes[below];
        if (cover.is_leaf(below)) {
          EXPECT_LE((other.centre - node.centre).norm() + other.radius, node.radius + 1e-9) << name;
        }
        EXPECT_LE(other.next, node.next);
      }
    }
  }
}

TEST(SphereCover, FewSpheresAreEnough) {
  const ShapesModel shapes;
  const auto leaves = [&](const std::string& name, double inflation) {
    return CoverWithSpheres(ConvexShapesOf(shapes.model(), shapes.Geom(name))[0], inflation)
        .leaves();
  };
  EXPECT_EQ(leaves("ball", 0.01), 1);
  EXPECT_LE(leaves("capsule", 0.01), 6);
  for (const std::string name : {"box", "cylinder", "ellipsoid", "mesh"}) {
    EXPECT_LE(leaves(name, 0.01), 120) << name;
    EXPECT_LT(leaves(name, 0.02), leaves(name, 0.01)) << name;
  }
}

TEST(SphereCover, ALargeBodyGetsFewSpheresAndALargerInflation) {
  ConvexShape wall;
  const Eigen::Vector3d half(2, 0.05, 1.5);
  wall.box = Eigen::AlignedBox3d(-half, half);
  for (int i = 0; i < 3; ++i) {
    wall.planes.push_back({Eigen::Vector3d::Unit(i), half[i]});
    wall.planes.push_back({-Eigen::Vector3d::Unit(i), half[i]});
  }
  const SphereCover cover = CoverWithSpheres(wall, 0.01);
  EXPECT_GT(cover.inflation, 0.01);
  EXPECT_LT(cover.leaves(), 2500);
}

}  // namespace
}  // namespace robocell::internal
