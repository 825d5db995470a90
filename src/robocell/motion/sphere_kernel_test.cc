#include "robocell/motion/sphere_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell::internal {
namespace {

// A slide along z, then a hinge about it that carries a ball of 10 cm on an arm of 1 m, beside one
// obstacle.
SphereTable ArmBeside(SphereTable::Obstacle obstacle, std::vector<SphereTable::Plane> planes = {}) {
  SphereTable t{.dofs = 2};
  t.links.resize(3);
  for (int k : {1, 2}) {
    SphereTable::Link& link = t.links[k];
    link.parent = k - 1;
    link.slide = k == 1;
    link.dof = k - 1;
    for (int i = 0; i < 3; ++i) link.rotation[4 * i] = 1;
  }
  t.nodes.push_back({{1, 0, 0, 0.1f}, 1});
  t.trees.push_back({.nodes = {0, 1}, .link = 2, .geom = 7});
  t.links[2].ball = {1, 0, 0, 0.1f};
  t.links[2].trees = {0, 1};
  t.links[2].near = {0, 1};
  t.near = {0};
  obstacle.geom = 8;
  if (!planes.empty()) obstacle.planes = {0, static_cast<int>(planes.size())};
  t.obstacles.push_back(obstacle);
  t.planes = std::move(planes);
  t.ignored = {0};
  return t;
}

bool Hits(const SphereTable& table, double height, double angle, float clearance = 0) {
  SphereScratch scratch;
  scratch.Fit(table);
  const double q[] = {height, angle};
  return FindSphereHits(table, {.clearance = clearance}, q, 1, false, &scratch) == 1;
}

SphereTable::Obstacle At(SphereTable::Shape shape, float x, float y, float z, float a, float b = 0,
                         float c = 0) {
  SphereTable::Obstacle o{.shape = shape, .centre = {x, y, z}, .size = {a, b, c}};
  for (int i = 0; i < 3; ++i) o.axes[4 * i] = 1;
  o.ball = {x, y, z, 2};
  return o;
}

TEST(SphereKernel, FindsTheDistanceAtWhichABallTouchesEachShape) {
  using Shape = SphereTable::Shape;
  // Above the ball at angle 0; they touch at the slide's height of 1.
  const SphereTable tables[] = {
      ArmBeside(At(Shape::kBall, 1, 0, 1.3f, 0.2f)),
      ArmBeside(At(Shape::kBox, 1, 0, 1.3f, 0.4f, 0.4f, 0.2f)),
      ArmBeside(At(Shape::kCapsule, 1, 0, 1.3f, 0.1f, 0.1f)),
      ArmBeside(At(Shape::kCylinder, 1, 0, 1.3f, 0.4f, 0.2f)),
      ArmBeside(At(Shape::kHalfSpace, 0, 0, 0, 0), {{{0, 0, -1}, -1.1f}}),
      ArmBeside(At(Shape::kPolytope, 1, 0, 2, 0),
                {{{0, 0, -1}, -1.1f}, {{1, 0, 0}, 1.2f}, {{-1, 0, 0}, -0.8f}})};
  for (const SphereTable& table : tables) {
    OnEveryInstructionSet([&](const std::string& name) {
      const std::string what =
          name + ", shape " + std::to_string(static_cast<int>(table.obstacles[0].shape));
      EXPECT_TRUE(Hits(table, 1.001, 0)) << what;
      EXPECT_FALSE(Hits(table, 0.999, 0)) << what;
      EXPECT_TRUE(Hits(table, 0.999, 0, 0.002f)) << what;
      if (table.obstacles[0].shape == Shape::kHalfSpace) return;
      EXPECT_FALSE(Hits(table, 1.001, 3)) << what;
      EXPECT_TRUE(Hits(table, 1.001, 8 * 2 * 3.14159265358979)) << what;
    });
  }
}

TEST(SphereKernel, NamesThePairsAndTheLanesThatMeet) {
  const SphereTable table = ArmBeside(At(SphereTable::Shape::kBall, 1, 0, 0, 0.2f));
  SphereScratch scratch;
  scratch.Fit(table);
  const std::vector<double> q = {0, 0, 0, 1, 0, 2, 0, -0.1, 5, 0};
  OnEveryInstructionSet([&](const std::string& name) {
    std::vector<SpherePair> pairs;
    FindSpherePairs(table, {}, q, 5, &scratch, &pairs);
    uint32_t lanes = 0;
    for (const SpherePair& pair : pairs) {
      EXPECT_EQ(pair.geom, 7);
      EXPECT_EQ(pair.other, 8);
      lanes |= pair.lanes;
    }
    EXPECT_EQ(lanes, 0b01001u) << name;
  });
  SphereTable allowed = table;
  allowed.ignored = {1};
  EXPECT_EQ(FindSphereHits(allowed, {}, q, 5, false, &scratch), 0u);
}

TEST(FindNearest, IsTheFirstOfTheNearestOnEveryInstructionSet) {
  Rng rng = Rng::Stream(1, "points");
  for (const int count : {1, 3, 8, 17, 100}) {
    const int stride = 104, dofs = 3;
    std::vector<float> points(stride * dofs);
    for (float& x : points) x = static_cast<float>(rng.UniformInt(4));
    const float q[] = {1, 2, 3};
    int expected = 0;
    float least = 1e9f;
    for (int i = 0; i < count; ++i) {
      float sum = 0;
      for (int k = 0; k < dofs; ++k) sum += std::pow(points[k * stride + i] - q[k], 2.0f);
      if (sum < least) least = sum, expected = i;
    }
    OnEveryInstructionSet([&](const std::string& name) {
      EXPECT_EQ(FindNearest(points.data(), stride, count, dofs, q), expected) << name;
    });
  }
}

}  // namespace
}  // namespace robocell::internal
