#include "robocell/task/push_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(PushMotion, GoesStraightFromBehindTheObjectTowardsThePlace) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = scene.shape();
  scene.scene.SyncPoses();
  const Eigen::Vector3d object = scene.scene.body_pose(scene.target_body).translation();
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d way = 0.1 * Eigen::Vector2d(std::cos(i), std::sin(i));
    const std::vector<ContactPath> paths =
        internal::PushPaths(scene.scene, "target", object.head<2>() + way, *shape);
    ASSERT_EQ(paths.size(), 4u);
    for (const ContactPath& path : paths) {
      const Eigen::Vector3d first = path.tcp_in_world.front().translation(),
                            last = path.tcp_in_world.back().translation();
      EXPECT_NEAR((last - first).head<2>().normalized().dot(way.normalized()), 1, 1e-6);
      EXPECT_NEAR(last.z(), first.z(), 1e-9);
      // It comes down behind the object.
      EXPECT_LT((first - object).head<2>().dot(way), 0);
    }
  }
  EXPECT_TRUE(internal::PushPaths(scene.scene, "target", object.head<2>(), *shape).empty());
}

}  // namespace
}  // namespace robocell
