#include "robocell/task/convex_solid.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

struct Solid {
  PickScene pick;
  std::vector<int> geoms;
  BodySolids solids;
};
Solid SolidOf(const char* kind) {
  Solid solid{MakePickScene(ObjectOnTheTable(kind)), {}, {}};
  const mjModel* m = solid.pick.scene.model();
  solid.geoms = CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, solid.pick.target_body));
  solid.solids = BodySolids(m, solid.pick.scene.data(), Pose(), solid.geoms);
  return solid;
}

// The oracle is the engine's ray against each primitive, from both sides.
TEST(ConvexSolid, LinesEnterAndLeavePrimitivesWhereTheEnginesRaysHit) {
  Rng rng = Rng::Stream(2, "solids");
  for (const int type :
       {mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_CYLINDER, mjGEOM_ELLIPSOID, mjGEOM_BOX}) {
    int hits = 0;
    for (int i = 0; i < 200; ++i) {
      mjtNum size[3] = {rng.Uniform(0.01, 0.05), rng.Uniform(0.01, 0.05), rng.Uniform(0.01, 0.05)};
      const Pose pose(RandomVector(rng, 0.05), RandomQuaternion(rng));
      mjtNum position[3], axes[9];
      std::copy_n(pose.translation().data(), 3, position);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = pose.rotation();
      std::copy_n(rows.data(), 9, axes);
      // A model of one geom is enough for what ConvexSolid reads.
      mjModel m = {};
      mjData d = {};
      int kind = type, mesh = -1;
      mjtNum box[6] = {0, 0, 0, 0.2, 0.2, 0.2};
      m.geom_type = &kind;
      m.geom_size = size;
      m.geom_aabb = box;
      m.geom_dataid = &mesh;
      d.geom_xpos = position;
      d.geom_xmat = axes;
      const ConvexSolid solid(&m, &d, 0, Pose());
      const Vector3d u = RandomDirection(rng), from = RandomVector(rng, 0.05) - 0.5 * u;
      mjtNum normal[3];
      const double in = mju_rayGeom(position, axes, size, from.data(), u.data(), type, normal);
      SolidSpan span;
      ASSERT_EQ(solid.Through(from, u, &span), in >= 0) << type;
      if (in < 0) continue;
      ++hits;
      const Vector3d behind = from + u, back = -u;
      mjtNum far_normal[3];
      const double out =
          1 - mju_rayGeom(position, axes, size, behind.data(), back.data(), type, far_normal);
      EXPECT_NEAR(span.begin, in, 1e-6) << type;
      EXPECT_NEAR(span.end, out, 1e-6) << type;
      EXPECT_LT((span.begin_normal - Vector3d(normal)).norm(), 1e-4) << type;
      EXPECT_LT((span.end_normal - Vector3d(far_normal)).norm(), 1e-4) << type;
      EXPECT_TRUE(solid.Contains(from + (span.begin + span.end) / 2 * u, 0));
      EXPECT_FALSE(solid.Contains(from + (span.begin - 1e-5) * u, 0));
      EXPECT_FALSE(solid.Contains(from + (span.end + 1e-5) * u, 0));
    }
    EXPECT_GT(hits, 20) << type;
  }
}

// Along a direction, the lines through many points reach from one end of the hull to the other.
TEST(ConvexSolid, HullsOfMeshesHaveTheExtentOfTheirVertices) {
  Rng rng = Rng::Stream(3, "hulls");
  for (const char* kind : {"mug", "bottle", "bracket"}) {
    const Solid solid = SolidOf(kind);
    for (int i = 0; i < 100; ++i) {
      const Vector3d u = RandomDirection(rng);
      const Vector3d from = solid.solids.centre() + RandomVector(rng, 0.03);
      double lower = 1e9, upper = -1e9;
      for (const int g : solid.geoms) {
        const Interval extent = GeomExtent(solid.pick.scene.model(), solid.pick.scene.data(), g, u);
        lower = std::min(lower, extent.lower);
        upper = std::max(upper, extent.upper);
      }
      double last = -1e9;
      for (const SolidSpan& span : solid.solids.Through(from, u)) {
        EXPECT_GT(span.begin, last) << "parts are apart and in order";
        EXPECT_GT(span.end, span.begin);
        EXPECT_GE(span.begin + from.dot(u), lower - 1e-6) << kind;
        EXPECT_LE(span.end + from.dot(u), upper + 1e-6) << kind;
        EXPECT_TRUE(solid.solids.Contains(from + (span.begin + span.end) / 2 * u)) << kind;
        last = span.end;
      }
    }
  }
}

}  // namespace
}  // namespace robocell::internal
