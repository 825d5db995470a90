// Tests which contacts of a mounted gripper are collisions.
#include "robocell/env/collision_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::IsEmpty;

class GripperCollisions : public ::testing::Test {
 protected:
  GripperCollisions() : config_(folder_.Duo()) {
    config_.world_frame_objects["post"] = {.offset = Pose(Eigen::Vector3d(5, 5, 5)),
                                           .fixed = false,
                                           .shape = Shape::kBox,
                                           .size = Vec3{0.02, 0.02, 0.02},
                                           .mass = 0.1};
  }

  RobotConfig& gripper() { return config_.grippers.at("left"); }

  // Returns the collisions when the post moves to a finger of the left gripper.
  std::vector<Collision> WhenAFingerIsTouched() {
    Scene scene = Scene::Build(EnvSceneSpec(config_));
    scene.Reset();
    CollisionMonitor monitor({{Robot::Of(scene, "left"), {Robot::Of(scene, "gripperleft")}},
                              {Robot::Of(scene, "right"), {Robot::Of(scene, "gripperright")}}});
    monitor.Begin();
    scene.SetBodyPose("post", scene.body_pose("gripperleft_left"));
    EXPECT_TRUE(scene.Step().ok());
    monitor.FindNew();
    return monitor.found();
  }

  TwoArmFolder folder_;
  EnvConfig config_;
};

TEST_F(GripperCollisions, AreReportedOnlyForNamedGeoms) {
  EXPECT_THAT(WhenAFingerIsTouched(), IsEmpty());
  gripper().collision_geoms = {{.name = "left_pad"}};
  const Collision expected{"left", "gripperleft_left", "", "post"};
  EXPECT_THAT(WhenAFingerIsTouched(), ::testing::Contains(expected));
}

TEST_F(GripperCollisions, ExcludeContactsBetweenFingers) {
  gripper().collision_geoms = {{.name = "left_pad"}, {.name = "right_pad"}};
  for (const Collision& collision : WhenAFingerIsTouched()) EXPECT_EQ(collision.other_body, "post");
}

TEST_F(GripperCollisions, ExcludeIgnoredGeoms) {
  gripper().collision_geoms = {{.name = "left_pad"}, {.name = "right_pad"}};
  gripper().ignored_collision_geoms = {"post_geom"};
  EXPECT_THAT(WhenAFingerIsTouched(), IsEmpty());
}

TEST_F(GripperCollisions, NameAMissingIgnoredGeom) {
  gripper().collision_geoms = {{.name = "left_pad"}};
  gripper().ignored_collision_geoms = {"pst_geom"};
  ExpectThrow<NotFoundError>([&] { WhenAFingerIsTouched(); },
                             "robot 'gripperleft': ignored_collision_geoms: no geom 'pst_geom'");
}

TEST_F(GripperCollisions, NameAMissingIgnoredGeomWithoutCollisionGeoms) {
  gripper().ignored_collision_geoms = {"pst_geom"};
  ExpectThrow<NotFoundError>([&] { WhenAFingerIsTouched(); },
                             "robot 'gripperleft': ignored_collision_geoms: no geom 'pst_geom'");
}

// An arm with a hand of its own.
TEST(HandCollisions, AreReportedForNamedGeoms) {
  const auto when_touched = [](const std::vector<ElementRef>& geoms) {
    EnvConfig config = Rc7Env();
    config.robots["robot"].collision_geoms = geoms;
    config.world_frame_objects["post"] = {.offset = Pose(Eigen::Vector3d(5, 5, 5)),
                                          .fixed = false,
                                          .shape = Shape::kBox,
                                          .size = Vec3{0.02, 0.02, 0.02},
                                          .mass = 0.1};
    Scene scene = Scene::Build(EnvSceneSpec(config));
    scene.Reset();
    CollisionMonitor monitor({{Robot::Of(scene, "robot"), {}}});
    monitor.Begin();
    const mjModel* m = scene.model();
    const int pad = FindId(m, mjOBJ_GEOM, "robotrobot_left_finger_pad");
    scene.SetBodyPose("post", Pose(Eigen::Vector3d(scene.data()->geom_xpos + 3 * pad)));
    EXPECT_TRUE(scene.Step().ok());
    monitor.FindNew();
    return monitor.found().size();
  };
  EXPECT_EQ(when_touched({}), 0u);
  EXPECT_EQ(when_touched({{.name = "left_finger_pad"}, {.name = "right_finger_pad"}}), 1u);
}

}  // namespace
}  // namespace robocell::internal
