// Tests that robots use the values written to a scene's model: from the next Forward() or reset on,
// and limits of a position command at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::DoubleNear;
using ::testing::Not;
using ::testing::Pointwise;

class WrittenModel : public ::testing::Test {
 protected:
  static Robot Build() {
    RobotSpec spec{.name = "rc7", .config = Rc7()};
    spec.config->gravcomp = false;
    spec.control_modes = std::vector{CtrlMode::kTorque};
    return Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  }
  mjModel* m() { return scene.mutable_model(); }
  int IdOf(mjtObj kind, const std::string& name) { return RequireId(m(), kind, name, "test"); }
  void MakeTheLastLinkHeavier() {
    m()->body_mass[IdOf(mjOBJ_BODY, robot.chain().joints().back().body)] += 3;
  }
  std::vector<double> Torques() const {
    std::vector<double> torques(7);
    robot.GravityTorques(torques);
    return torques;
  }
  std::vector<double> Needed() const {
    std::vector<double> needed;
    for (const ChainJoint& joint : robot.chain().joints())
      needed.push_back(scene.data()->qfrc_bias[joint.dof_address]);
    return needed;
  }

  Robot robot = Build();
  Scene scene = robot.scene();
};

TEST_F(WrittenModel, UpdatesMassesAfterForward) {
  const std::vector<double> before = Torques();
  MakeTheLastLinkHeavier();
  EXPECT_EQ(Torques(), before) << "not announced yet";
  scene.Forward();
  EXPECT_NE(Torques(), before);
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), Needed()));
}

TEST_F(WrittenModel, UpdatesMassesAndTorquesAfterAReset) {
  robot.set_ctrl_mode(CtrlMode::kTorque);
  MakeTheLastLinkHeavier();
  scene.Reset();
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), Needed()));
  const std::vector<double> start = robot.arm().joint_pos();
  for (int i = 0; i < 200; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_THAT(robot.arm().joint_pos(), Pointwise(DoubleNear(1e-3), start));
}

TEST_F(WrittenModel, UpdatesMassesWithinTheResetOfAHook) {
  scene.AddResetHook([this](ResetContext&) { MakeTheLastLinkHeavier(); });
  for (int i = 0; i < 3; ++i) {
    scene.Reset();
    EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), Needed())) << i;
  }
}

TEST_F(WrittenModel, MovesTheTipOfTheChainAndItsLimits) {
  const int tcp = IdOf(mjOBJ_SITE, robot.tcp_site());
  const int joint = IdOf(mjOBJ_JOINT, robot.joint_names()[3]);
  m()->site_pos[3 * tcp + 2] += 0.1;
  m()->jnt_range[2 * joint] -= 0.25;
  scene.Forward();
  EXPECT_TRUE(
      (robot.base_in_world() * robot.FkFrame()).is_close(robot.tcp_in_world(), 1e-12, 1e-12));
  EXPECT_EQ(robot.chain().joints()[3].lower, m()->jnt_range[2 * joint]);
  EXPECT_EQ(robot.joint_limits()[3].lower, m()->jnt_range[2 * joint]);
}

TEST_F(WrittenModel, LimitsAPositionCommandFromTheNextUpdateOn) {
  const int joint = IdOf(mjOBJ_JOINT, robot.joint_names()[1]);
  std::vector<double> far = robot.arm().joint_pos();
  const auto sent = [&] {
    robot.SetJntPosCmd(far);
    robot.Update();
    return robot.arm().ctrl()[1];
  };
  const mjtNum* range = m()->jnt_range + 2 * joint;
  far[1] = range[1] + 0.5;
  const int input = m()->actuator_ctrladr[IdOf(mjOBJ_ACTUATOR, robot.arm().actuator_names()[1])];
  m()->actuator_ctrlrange[2 * input + 1] = range[1] + 1;
  const double limited = sent();
  m()->jnt_range[2 * joint + 1] += 0.5;
  EXPECT_GT(sent(), limited);
  m()->jnt_range[2 * joint + 1] -= 1;
  EXPECT_LT(sent(), limited);
}

TEST_F(WrittenModel, UsesTheRefreshedGripperPose) {
  robot.gripper().SetJointPos(std::vector<double>(robot.gripper().nq(), 0.0));
  robot.RefreshToolInertia();
  MakeTheLastLinkHeavier();
  scene.Forward();
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), Needed()));
}

TEST_F(WrittenModel, KeepsTheRefreshedGripperPoseThroughRebuilds) {
  const std::vector<double> at_the_reference = Torques();
  std::vector<double> fingers(robot.gripper().nq());
  fingers[0] = 0.03;  // only one of them: together they keep their centre of mass
  robot.gripper().SetJointPos(fingers);
  robot.RefreshToolInertia();
  const std::vector<double> refreshed = Torques();
  ASSERT_THAT(refreshed, Pointwise(DoubleNear(1e-9), Needed()));
  ASSERT_THAT(refreshed, Not(Pointwise(DoubleNear(1e-4), at_the_reference)));
  scene.AddObject(BoxObject("box", {3, 0, 0.1}));
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), refreshed));
  scene.RemoveObject("box");
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), refreshed));
  scene.Reset();
  EXPECT_THAT(Torques(), Pointwise(DoubleNear(1e-9), at_the_reference)) << "until a reset";
}

TEST_F(WrittenModel, AcceptsQuaternionsOfAnyLength) {
  const int body = IdOf(mjOBJ_BODY, robot.chain().joints()[2].body);
  for (int k = 0; k < 4; ++k) m()->body_quat[4 * body + k] = 2 * m()->body_quat[4 * body + k] + 0.1;
  scene.Forward();
  EXPECT_TRUE(
      (robot.base_in_world() * robot.FkFrame()).is_close(robot.tcp_in_world(), 1e-12, 1e-12));
}

TEST_F(WrittenModel, KeepsTheChainWithoutEdits) {
  const LinkTable* before = &robot.chain().links();
  scene.Forward();
  scene.Reset();
  m()->geom_rgba[0] = 0.5;
  scene.Forward();
  EXPECT_EQ(&robot.chain().links(), before);
}

}  // namespace
}  // namespace robocell
