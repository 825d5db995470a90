#include "robocell/motion/geom_extent.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

// The oracle for the lowest point is the engine's distance to a floor.
TEST(GeomExtent, MatchesTheEnginesDistanceToTheFloor) {
  Rng rng = Rng::Stream(1, "extent");
  for (const char* kind : {"box", "cylinder", "sphere", "bracket", "nut"}) {
    PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    const mjModel* m = pick.scene.model();
    const int floor = [&] {
      int g = 0;
      while (m->geom_type[g] != mjGEOM_PLANE) ++g;
      return g;
    }();
    const int body = FindId(m, mjOBJ_BODY, pick.target_body);
    for (int i = 0; i < 20; ++i) {
      pick.scene.SetBodyPose(pick.target_body, Pose({3, 0, 1}, RandomQuaternion(rng)));
      for (const int g : CollisionGeomsOf(m, body)) {
        const double down = GeomExtent(m, pick.scene.data(), g, Eigen::Vector3d::UnitZ()).lower;
        const double oracle = mj_geomDistance(m, pick.scene.data(), floor, g, 10, nullptr);
        EXPECT_NEAR(down, oracle, 1e-5) << kind << " " << Describe(m, mjOBJ_GEOM, g);
      }
    }
  }
}

TEST(GeomExtent, TheOppositeDirectionFlipsTheSigns) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("bracket"));
  const mjModel* m = pick.scene.model();
  Rng rng = Rng::Stream(2, "extent");
  for (const int g : CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, pick.target_body))) {
    const Eigen::Vector3d u = RandomDirection(rng);
    const Interval there = GeomExtent(m, pick.scene.data(), g, u);
    const Interval back = GeomExtent(m, pick.scene.data(), g, -u);
    EXPECT_LT(there.lower, there.upper);
    EXPECT_NEAR(there.lower, -back.upper, 1e-12);
    EXPECT_NEAR(there.upper, -back.lower, 1e-12);
  }
}

// No point of a geom lies farther from the body's origin than its radius, along any direction.
TEST(GeomExtent, TheRadiusBoundsAllGeoms) {
  Rng rng = Rng::Stream(3, "extent");
  for (const char* kind : {"box", "sphere", "mug", "bracket"}) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    const mjModel* m = pick.scene.model();
    const int body = FindId(m, mjOBJ_BODY, pick.target_body);
    const double radius = RadiusOf(m, body);
    double farthest = 0;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d u = RandomDirection(rng);
      const Eigen::Vector3d origin(pick.scene.data()->xpos + 3 * body);
      for (const int g : CollisionGeomsOf(m, body))
        farthest = std::max(farthest, GeomExtent(m, pick.scene.data(), g, u).upper - u.dot(origin));
    }
    EXPECT_LE(farthest, radius + 1e-9) << kind;
    EXPECT_GE(farthest, 0.5 * radius) << kind << ": the bound is of the object's size";
  }
}

}  // namespace
}  // namespace robocell::internal
