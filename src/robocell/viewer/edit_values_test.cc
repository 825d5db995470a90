#include "robocell/viewer/edit_values.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/scene/actuator_kind.h"
#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, SlidersMoveJointsAndControls) {
  Robot robot = Robot::Of(scene_, "arm");
  Viewer viewer = Viewer::Open(robot, kInMemory);
  viewer.set_paused(true);
  viewer.ShowPanels("", "Joints");
  const std::string joint = robot.joint_names()[1];
  const double before = scene_.joint_pos(joint);
  Click(viewer, "Joints", joint.c_str(), 40);
  const double after = scene_.joint_pos(joint);
  EXPECT_NE(after, before);
  EXPECT_NEAR(robot.jnt_pos_cmd()[1], after, 1e-9) << "the robot holds it";
  viewer.ShowPanels("", "Controls");
  const std::string actuator = internal::NamedActuators(scene_.model())[1];
  const double command = robot.jnt_pos_cmd()[1], ctrl = scene_.actuator_ctrl(actuator);
  Click(viewer, "Controls", actuator.c_str(), 20);
  EXPECT_NE(scene_.actuator_ctrl(actuator), ctrl);
  EXPECT_NE(robot.jnt_pos_cmd()[1], command) << "the robot keeps it";
}

// Sliders of controls in radians, and in an actuator's own units, 0 to 255.
TEST_F(Viewers, TheCommandOfAControlIsWhereItsServoRests) {
  Robot robot = Robot::Of(scene_, "arm");
  const std::string joint = robot.joint_names()[1];
  mjModel* m = scene_.mutable_model();
  int id = -1;
  for (int i = 0; i < static_cast<int>(m->nactuator); ++i) {
    const std::string name = mj_id2name(m, mjOBJ_JOINT, m->actuator_trnid[2 * i]);
    if (name == joint && internal::IsPositionServo(m, i)) id = i;
  }
  ASSERT_GE(id, 0);
  const std::string actuator = mj_id2name(m, mjOBJ_ACTUATOR, id);
  internal::SetControl(scene_, {robot}, actuator, 0.3);
  EXPECT_NEAR(robot.jnt_pos_cmd()[1], 0.3 / m->actuator_gear[6 * id], 1e-9);
  m->actuator_gainprm[mjNGAIN * id] /= 100;  // 100 units a radian, 20 of them at 0
  m->actuator_biasprm[mjNBIAS * id] = -20 * m->actuator_gainprm[mjNGAIN * id];
  internal::SetControl(scene_, {robot}, actuator, 50);
  EXPECT_NEAR(robot.jnt_pos_cmd()[1] * m->actuator_gear[6 * id], 0.3, 1e-9);
}

}  // namespace
}  // namespace robocell
