#include "robocell/task/handle_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

Scene SceneWith(const std::string& kind, double yaw) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "unit",
                          .mjcf_path = kind,
                          .pos = Vec3{0.3, -0.2, 0},
                          .euler = {0, 0, yaw},
                          .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(HandleMotion, FindsTheBarAndItsFront) {
  for (const double yaw : {0.0, 50.0, -130.0}) {
    const Eigen::Vector3d front(std::cos(yaw * M_PI / 180), std::sin(yaw * M_PI / 180), 0);
    for (const char* joint : {"unit_upper_drawer_slide", "unit_lower_drawer_slide"}) {
      const Scene scene = SceneWith("chest", yaw);
      const JointOpening opening = JointOpening::Of(scene, joint);
      const auto bar = internal::FindHandle(scene, opening);
      ASSERT_TRUE(bar.has_value());
      EXPECT_NEAR(bar->radius, 0.006, 1e-9);
      EXPECT_NEAR(bar->half_length, 0.06, 1e-9);
      EXPECT_NEAR(bar->outward.dot(front), 1, 1e-6);
      EXPECT_NEAR(internal::FrontOf(scene, opening)->dot(front), 1, 1e-6);
    }
    const Scene lid = SceneWith("lid_box", yaw);
    const JointOpening opening = JointOpening::Of(lid, "unit");
    EXPECT_NEAR(internal::FindHandle(lid, opening)->outward.z(), 1, 1e-6);
    EXPECT_NEAR(internal::FrontOf(lid, opening)->dot(front), 1, 1e-6);
  }
}

// The point between the pads stays on the bar wherever the joint is: the engine says where that is.
TEST(HandleMotion, PathsFollowTheHandleOfTheEngine) {
  const PickScene hand = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = hand.shape();
  for (const char* kind : {"chest", "cupboard", "lid_box"}) {
    Scene scene = SceneWith(kind, 30);
    const std::string joint = kind == std::string("chest") ? "unit_upper_drawer" : "unit";
    JointOpening opening = JointOpening::Of(scene, joint);
    const std::vector<ContactPath> paths = internal::HandlePaths(scene, opening, *shape, 0.7);
    ASSERT_FALSE(paths.empty()) << kind;
    const double width = 2 * internal::FindHandle(scene, opening)->radius;
    for (const double share : {0.0, 0.7}) {
      opening.Put(share);
      scene.Forward();
      const internal::HandleBar bar = *internal::FindHandle(scene, opening);
      const auto distance_to = [&](const Eigen::Vector3d& point) {
        const double along =
            std::clamp((point - bar.middle).dot(bar.axis), -bar.half_length, bar.half_length);
        return (point - bar.middle - along * bar.axis).norm();
      };
      for (const ContactPath& path : paths) {
        const Pose& tcp = share == 0 ? path.tcp_in_world.front() : path.tcp_in_world.back();
        EXPECT_LT(distance_to(tcp * shape->grasp_in_tcp() * shape->PadAt(width)), 1e-6) << kind;
      }
    }
    opening.Put(0);
  }
}

TEST(HandleMotion, AimsSomewhatFurtherThanTheGoal) {
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d open 0.5")), 0.6, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d open 0.95")), 1, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d closed 0.15")), 0.05, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d closed 0.05")), 0, 1e-9);
}

TEST(HandleMotion, PressesAlongTheSlideBeyondItsEnd) {
  const PickScene hand = MakePickScene(ObjectOnTheTable("box"));
  const Scene scene = SceneWith("button_panel", 20);
  const JointOpening button = JointOpening::Of(scene, "unit_green_button");
  for (const ContactPath& path : internal::PressPaths(scene, button, *hand.shape())) {
    const Eigen::Vector3d way =
        path.tcp_in_world.back().translation() - path.tcp_in_world.front().translation();
    EXPECT_NEAR(way.z(), -0.013, 1e-3);
    EXPECT_LT(way.head<2>().norm(), 1e-9);
  }
}

}  // namespace
}  // namespace robocell
