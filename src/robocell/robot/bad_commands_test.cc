// Every way into the engine refuses numbers that are none and wrong counts, names robot and group,
// and leaves nothing behind. Robot::Apply has its own tests.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <functional>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::string kArm = "robot 'rc7' / group 'arm'";
const std::string kGripper = "robot 'rc7' / group 'gripper'";

class BadCommands : public ::testing::Test {
 protected:
  std::vector<double> Ctrl() {
    const Scene scene = robot.scene();
    return {scene.data()->ctrl, scene.data()->ctrl + scene.model()->nu};
  }
  // The call is refused with the text, and the robot then moves as one that was never asked.
  void Refuses(const std::function<void()>& call, const std::string& text) {
    const std::vector<double> ctrl = Ctrl(), state = robot.scene().state();
    ExpectThrow<ArgumentError>(call, text);
    EXPECT_EQ(Ctrl(), ctrl) << text;
    EXPECT_EQ(robot.scene().state(), state) << text;
    robot.Update();
    EXPECT_TRUE(robot.Step().ok()) << text;
  }
  std::vector<double> WithNan(std::vector<double> values, int at) {
    values[at] = kNan;
    return values;
  }

  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = Rc7().home.at("arm");
};

TEST_F(BadCommands, ControllersNameRobotAndGroup) {
  for (const char* kind : {"joint_position", "relative_joint_position"}) {
    robot.SetController("arm", kind);
    Controller& arm = robot.controller("arm");
    Refuses([&] { arm.SetTarget(std::vector<double>(6)); },
            kArm + ": expected 7 joint values, got 6");
    Refuses([&] { arm.SetTarget(WithNan(home, 3)); },
            kArm + ": the target of 'joint4' is nan; targets must be finite");
  }
  Controller& gripper = robot.controller("gripper");
  Refuses([&] { gripper.SetTarget(std::vector<double>(2)); },
          kGripper + ": expected 1 opening value, got 2");
  Refuses([&] { gripper.SetTarget(std::vector{kNan}); },
          kGripper + ": the target of 'opening' is nan");
}

TEST_F(BadCommands, GroupsNameTheElement) {
  MoveGroup& arm = robot.arm();
  Refuses([&] { arm.SetCtrl(std::vector<double>(8)); },
          kArm + ": expected 7 control values, got 8");
  Refuses([&] { arm.SetCtrl(WithNan(home, 0)); },
          kArm + ": actuator 'servo1' cannot be set to nan");
  Refuses([&] { arm.SetJointPos(WithNan(home, 6)); },
          kArm + ": joint 'joint7' cannot be set to nan");
  Refuses([&] { arm.SetJointVel(std::vector<double>{}); },
          kArm + ": expected 7 joint velocity values, got 0");
  Refuses([&] { robot.gripper().SetOpening(kNan); }, kGripper + ": opening cannot be nan");
}

TEST_F(BadCommands, PortsNameTheJointAndRecover) {
  Refuses([&] { robot.SetJntPosCmd(WithNan(home, 1)); }, kArm + ": the target of 'joint2' is nan");
  const std::vector<double> ctrl = Ctrl();
  robot.jnt_pos_cmd()[1] = kNan;
  for (int i = 0; i < 2; ++i) {
    ExpectThrow<ArgumentError>([&] { robot.Update(); },
                               kArm + ": the target of 'joint2' is nan; targets must be finite");
  }
  EXPECT_EQ(Ctrl(), ctrl);
  robot.SetJntPosCmd(home);
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
}

TEST_F(BadCommands, EveryPortNamesTheJoint) {
  RobotSpec spec{.name = "rc7", .config = Rc7()};
  spec.control_modes = std::vector{CtrlMode::kVelocity, CtrlMode::kTorque};
  robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  for (const CtrlMode mode : {CtrlMode::kVelocity, CtrlMode::kTorque}) {
    robot.set_ctrl_mode(mode);
    const std::vector<double> ctrl = Ctrl();
    robot.controller("arm").command_port()[2] = kNan;
    ExpectThrow<ArgumentError>([&] { robot.Update(); },
                               kArm + ": the target of 'joint3' is nan; targets must be finite");
    EXPECT_EQ(Ctrl(), ctrl);
  }
}

TEST_F(BadCommands, APoseThatOverflowedIsNoTarget) {
  const Pose far(Eigen::Vector3d(1.7e308, 0, 0));
  Refuses(
      [&] {
        robot.Apply({{"arm", GroupCommand::LeafPose(far * far)}});
      },
      kArm + ": the target pose has a number that is not finite");
}

TEST_F(BadCommands, ScenesNameTheActuatorAndTheBody) {
  Scene scene = robot.scene();
  Refuses([&] { scene.SetActuatorCtrl("servo3", kNan); },
          "scene 'test': control of actuator 'servo3' must be a finite number, got nan");
  Refuses(
      [&] {
        scene.SetBodyWrench("link3", {0, kNan, 0}, {0, 0, 0});
      },
      "scene 'test': force on body 'link3' must be a finite number, got nan");
  Refuses([&] { scene.SetState(std::vector<double>(3)); }, "scene 'test': a state has ");
}

}  // namespace
}  // namespace robocell
