#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/arm_scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class RobotOverrides : public ArmScenes {};

TEST_F(RobotOverrides, ApplyOnlyToTheirRobot) {
  config.gravcomp = true;
  config.stiffness = 321;
  config.damping = 12;
  config.force_limit = 7;
  SceneSpec spec = ArmScene();
  spec.robots.push_back({.path = config.model, .prefix = "other_"});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  for (const char* name : {"l_servo1", "l_servo2"}) {
    EXPECT_EQ(Prm(scene, m->actuator_gainprm, mjNGAIN, name, 0), 321);
    EXPECT_EQ(Prm(scene, m->actuator_biasprm, mjNBIAS, name, 1), -321);
    EXPECT_EQ(Prm(scene, m->actuator_biasprm, mjNBIAS, name, 2), -12);
    EXPECT_EQ(Prm(scene, m->actuator_forcerange, 2, name, 1), 7);
  }
  EXPECT_EQ(Prm(scene, m->actuator_gainprm, mjNGAIN, "other_servo1", 0), 100);
  EXPECT_EQ(m->body_gravcomp[RequireId(m, mjOBJ_BODY, "l_fore", "")], 1);
  EXPECT_EQ(m->body_gravcomp[RequireId(m, mjOBJ_BODY, "other_fore", "")], 0);
}

TEST_F(RobotOverrides, RejectGainsForOtherActuators) {
  config.model = folder.Write(
      "motors",
      R"(<worldbody><body name="base"><geom size="0.1"/><body><joint name="shoulder" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>
      <actuator><motor name="servo1" joint="shoulder"/></actuator>)");
  config.move_groups["arm"] = {
      .kind = MoveGroupKind::kArm, .joints = {"shoulder"}, .actuators = {"servo1"}};
  config.stiffness = 10;
  ExpectThrow<SpecError>(
      [&] { BuildArm(); },
      "stiffness, damping and force_limit are for position servos; actuator 'servo1' is none");
}

// The gains of force = gain * ctrl + a + b * length.
TEST_F(RobotOverrides, StiffenScaledServosWithoutMovingThem) {
  config.model = folder.Write(
      "scaled",
      R"(<worldbody><body name="base"><geom size="0.1"/><body><joint name="shoulder" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>
      <actuator><general name="servo1" joint="shoulder" gainprm="0.5" biastype="affine" biasprm="-2 -4 -1"/></actuator>)");
  config.move_groups["arm"] = {.kind = MoveGroupKind::kArm, .joints = {"shoulder"}};
  config.stiffness = 40;
  const Scene scene = BuildArm();
  const mjModel* m = scene.model();
  const int servo = RequireId(m, mjOBJ_ACTUATOR, "l_servo1", "");
  EXPECT_DOUBLE_EQ(m->actuator_gainprm[mjNGAIN * servo], 5);
  EXPECT_DOUBLE_EQ(m->actuator_biasprm[mjNBIAS * servo], -20);
  EXPECT_EQ(m->actuator_biasprm[mjNBIAS * servo + 1], -40);
  EXPECT_EQ(m->actuator_biasprm[mjNBIAS * servo + 2], -1);
}

TEST_F(RobotOverrides, AddATcpSiteAtTheOffset) {
  config.move_groups["arm"].leaf.reset();
  config.attachment_site = "flange";
  config.tcp_offset = Pose::FromRpy({0, 0, 0.1}, {0, 0, 1});
  const Scene scene = BuildArm();
  const RobotRecord& robot = scene.compiled()->robot("left");
  EXPECT_EQ(robot.attachment_site, "l_flange");
  ASSERT_EQ(robot.tcp_site, "l_tcp");
  EXPECT_TRUE(scene.site_pose("l_tcp").is_close(scene.site_pose("l_flange") * *config.tcp_offset,
                                                1e-9, 1e-9));
}

}  // namespace
}  // namespace robocell
