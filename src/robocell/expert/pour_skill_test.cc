// The rollouts are among the soak tests (tests/reliability/test_success_table.py): what flows takes
// seconds to simulate.
#include <gtest/gtest.h>

#include "robocell/expert/skill.h"
#include "robocell/math/rotation.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held_relation.h"
#include "robocell/task/pouring.h"

namespace robocell {
namespace {

TEST(PourSkill, FollowsPathsThatKeepTheVesselUprightUntilItIsOverTheOther) {
  internal::RegisterTaskRelations();
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "bottle", .mjcf_path = "open_bottle", .pos = Vec3{0.3, 0, 0.075}});
  spec.objects.push_back({.name = "bowl", .mjcf_path = "receiver", .pos = Vec3{0, 0.1, 0.04}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Pose lifted = Pose(Eigen::Vector3d(0, 0, 0.1)) * scene.body_pose("bottle_open_bottle");
  const internal::Vessel bottle(scene, "bottle"), bowl(scene, "bowl");
  const auto paths = internal::PourPaths(
      scene, {.subject = "bottle", .relation = "poured_into", .reference = "bowl"}, lifted);
  ASSERT_FALSE(paths.empty());
  for (const internal::HeldPath& path : paths) {
    EXPECT_TRUE(path.front().is_close(lifted, 1e-9, 1e-9));
    for (const Pose& pose : path) {
      const Eigen::Vector3d mouth = pose * bottle.mouth(), goal = bowl.pose() * bowl.mouth();
      const bool is_over = (mouth - goal).head<2>().norm() < bowl.radius();
      EXPECT_GT(mouth.z(), is_over ? goal.z() : 0);
      EXPECT_TRUE(is_over || pose.rotation()(2, 2) > 0.999) << "a tilted vessel is over the other";
    }
    EXPECT_LT(path.back().rotation()(2, 2), -0.5) << "in the end the mouth points down";
  }
}

}  // namespace
}  // namespace robocell
