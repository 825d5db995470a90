// Tests commands beyond limits: clamped and logged once, on every path.
#include "robocell/robot/beyond_limits.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BeyondLimitsTest : public ::testing::Test {
 protected:
  std::vector<std::string> lines_;
  ScopedLogSink sink_{[this](LogLevel, std::string_view text) { lines_.emplace_back(text); }};
};

TEST_F(BeyondLimitsTest, ClampsToTheNearestValueAndWarnsOnce) {
  BeyondLimits beyond;
  const auto what = [] { return std::string("it"); };
  EXPECT_EQ(beyond.Clamp(0.5, {0, 1}, what), 0.5);
  EXPECT_EQ(beyond.Clamp(1.0001, {0, 1}, what), 1) << "a small overshoot is not worth a word";
  EXPECT_TRUE(std::isnan(beyond.Clamp(NAN, {0, 1}, what))) << "to be refused by whoever uses it";
  EXPECT_THAT(lines_, IsEmpty());
  EXPECT_EQ(beyond.Clamp(50, {0, 1}, what), 1);
  EXPECT_EQ(beyond.Clamp(-50, {0, 1}, what), 0);
  EXPECT_THAT(lines_, ElementsAre("it is commanded to 50, beyond [0, 1]; the nearest value inside "
                                  "is used (reported once)"));
}

// A joint commanded beyond its limit is driven to the limit, by the port and by an action.
TEST_F(BeyondLimitsTest, AnArmMovesToItsLimits) {
  Robot robot = RobotAlone(Rc7());
  const Interval limits = robot.joint_limits()[3];
  robot.jnt_pos_cmd()[3] = 90;
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[3], limits.upper);
  EXPECT_EQ(robot.jnt_pos_cmd()[3], 90) << "the port keeps what was written";
  ASSERT_EQ(lines_.size(), 1u);
  EXPECT_THAT(lines_[0], HasSubstr("group 'arm': joint 'joint4' is commanded to 90, beyond ["));
  std::vector<double> q = robot.arm().joint_pos();
  q[3] = -90;
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[3], limits.lower);
  EXPECT_EQ(lines_.size(), 1u);
}

TEST_F(BeyondLimitsTest, ATeleportBeyondTheLimitsIsAcceptedWithAWarning) {
  Robot robot = RobotAlone(Rc7());
  const Interval limits = robot.joint_limits()[3];
  std::vector<double> q = robot.arm().joint_pos();
  robot.SetJointPos(q);
  q[3] = limits.upper;
  robot.SetJointPos(q);
  EXPECT_THAT(lines_, IsEmpty());
  q[3] = limits.upper + 1;
  robot.SetJointPos(q, false);
  EXPECT_EQ(robot.arm().joint_pos()[3], q[3]);
  EXPECT_THAT(lines_, ElementsAre(fmt::format(
                          "robot 'rc7' / group 'arm': joint 'joint4' is set to {:g}, outside its "
                          "limits {:g} to {:g}, which push it back (reported once)",
                          q[3], limits.lower, limits.upper)));
  robot.SetJointPos(q);
  EXPECT_EQ(lines_.size(), 1u);
}

// Positions without a command are not logged, and later commands still are.
TEST_F(BeyondLimitsTest, HoldingBeyondAServoRangeIsNotACommand) {
  RobotConfig config = Rc7();
  const double home = config.home.at("arm")[3];
  Edit edit;
  edit.actuator = ElementRef{.name = "servo4"};
  edit.ctrlrange = Vec2{-1, home - 0.3};
  config.edits.push_back(edit);
  config.force_limit = 0.1;  // less than gravity requires
  config.gravcomp = false;
  RobotSpec spec{.name = "rc7", .config = config};
  spec.control_modes = std::vector{CtrlMode::kTorque};
  Robot robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  const auto run = [&] {
    for (int i = 0; i < 3; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
  };
  std::vector<double> ctrl(7);
  robot.arm().CtrlForJointPos(robot.arm().joint_pos(), ctrl);
  EXPECT_EQ(ctrl[3], home - 0.3) << "a query logs nothing";
  run();
  robot.jnt_pos_cmd()[0] += 0.1;  // another joint
  run();
  robot.set_ctrl_mode(CtrlMode::kTorque);
  run();
  robot.SetJointPos(robot.arm().joint_pos());
  run();
  EXPECT_THAT(lines_, IsEmpty());
  robot.jnt_trq_cmd()[1] = 50;
  run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("the torque of joint 'joint2' is commanded to 50")));
  lines_.clear();
  robot.set_ctrl_mode(CtrlMode::kPosition);
  robot.jnt_pos_cmd()[3] = home - 0.1;
  run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("actuator 'servo4', by its ctrlrange, is commanded")));
}

// The limits count at the time of the command, not earlier ones.
TEST_F(BeyondLimitsTest, MotorLimitsComeFromTheModel) {
  RobotSpec spec{.name = "rc7", .config = Rc7()};
  spec.control_modes = std::vector{CtrlMode::kTorque};
  Scene scene = Scene::Build(SceneWith(spec));
  Robot robot = Robot::Of(scene, "rc7");
  robot.set_ctrl_mode(CtrlMode::kTorque);
  mjModel* m = scene.mutable_model();
  const int motor = FindId(m, mjOBJ_ACTUATOR, "joint1_torque");
  const auto limit = [&](double low, double high) {
    m->actuator_forcelimited[motor] = 1;
    m->actuator_forcerange[2 * motor] = low;
    m->actuator_forcerange[2 * motor + 1] = high;
    m->jnt_actfrclimited[FindId(m, mjOBJ_JOINT, "joint1")] = 0;
  };
  limit(-500, 500);
  robot.jnt_trq_cmd()[0] = 400;
  robot.Update();
  EXPECT_THAT(lines_, IsEmpty());
  // Two limits that do not overlap: the engine's result counts.
  limit(-5, 5);
  m->actuator_ctrllimited[m->actuator_ctrladr[motor]] = 1;
  m->actuator_ctrlrange[2 * m->actuator_ctrladr[motor]] = 10;
  m->actuator_ctrlrange[2 * m->actuator_ctrladr[motor] + 1] = 20;
  robot.Update();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("is commanded to 400, beyond [5, 5]")));
  EXPECT_TRUE(robot.Step().ok());
  EXPECT_EQ(robot.arm().joint_torque()[0], 5);
}

TEST_F(BeyondLimitsTest, WarnsAboutAnOpeningInPercent) {
  Robot robot = RobotAlone(Rc7());
  robot.gripper().SetOpening(50);
  EXPECT_EQ(robot.gripper().ctrl()[0], robot.gripper().ctrl_for_opening(1));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("group 'gripper': opening is commanded to 50")));
  lines_.clear();
  robot.Apply({{"gripper", GroupCommand::Opening(-2)}});
  EXPECT_EQ(robot.gripper().ctrl()[0], robot.gripper().ctrl_for_opening(0));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("group 'gripper': opening is commanded to -2")));
}

// Also at run time: a servo commanded beyond its ctrlrange, a motor beyond its force.
TEST(BeyondLimits, WarnsOnceAboutCommandsThatAServoClamps) {
  ModelFolder folder;
  const std::string model = folder.Write("bar", R"(<compiler angle="radian"/><worldbody>
<body name="post" pos="0 0 1"><geom size="0.02" pos="0 0 -0.5"/><body name="bar">
<joint name="hip" axis="0 1 0" range="-2 2"/><geom type="capsule" size="0.02"
fromto="0.02 0 0 0.48 0 0" mass="1"/><site name="tip" pos="0.5 0 0"/></body></body></worldbody>
<actuator><position name="drive" joint="hip" kp="2000" kv="100" ctrlrange="-1 1"
forcerange="-30 30"/></actuator>)");
  const std::string file = (folder.path() / "bar.yaml").string();
  AtomicWrite(file, fmt::format("name: bar\nmodel: {}\nmove_groups:\n"
                                "  arm: {{kind: arm, joints: [hip], leaf: {{site: tip}}}}\n",
                                model));
  Robot robot = RobotAlone(RobotConfig::Load(file));
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  for (int i = 0; i < 3; ++i) {
    robot.SetJntPosCmd(std::vector<double>{1.5});
    robot.Update();
  }
  EXPECT_EQ(robot.arm().ctrl()[0], 1);
  EXPECT_THAT(lines,
              ElementsAre("robot 'bar' / group 'arm': actuator 'drive', by its ctrlrange, is "
                          "commanded to 1.5, beyond [-1, 1]; the nearest value inside is "
                          "used (reported once)"));
  lines.clear();
  robot.set_ctrl_mode(CtrlMode::kTorque);
  for (int i = 0; i < 3; ++i) {
    robot.SetJntTrqCmd(std::vector<double>{-500});
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.jnt_trq_msr()[0], -30, 1e-9);
  EXPECT_THAT(
      lines,
      ElementsAre("robot 'bar' / group 'arm': the torque of joint 'hip' is commanded "
                  "to -500, beyond [-30, 30]; the nearest value inside is used (reported once)"));
}

}  // namespace
}  // namespace robocell
