// Tests arms without position servos: with motors, velocity servos, actuators of other kinds or
// several kinds, or none; what drives them, with and without a configuration, and the messages
// otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kMotors =
    R"(<motor name="m1" joint="shoulder" gear="2"/><motor name="m2" joint="elbow"/>)";
constexpr const char* kVelocities =
    R"(<velocity name="v1" joint="shoulder" kv="20"/><velocity name="v2" joint="elbow" kv="9"/>)";
constexpr const char* kPairs =
    R"(<position name="p1" joint="shoulder" kp="100"/><velocity name="v1" joint="shoulder" kv="20"/>
       <position name="p2" joint="elbow" kp="60"/><velocity name="v2" joint="elbow" kv="9"/>)";
constexpr const char* kIntegrating =
    R"(<intvelocity name="i1" joint="shoulder" kp="100" actrange="-2 2"/>
       <intvelocity name="i2" joint="elbow" kp="100" actrange="-2 2"/>)";
constexpr const char* kWithoutGear =
    R"(<motor name="m1" joint="shoulder" gear="0"/><motor name="m2" joint="elbow"/>)";
constexpr const char* kHalf =
    R"(<position name="s1" joint="shoulder" kp="100"/><motor name="m2" joint="elbow"/>)";

class MotorArms : public ::testing::Test {
 protected:
  // The two-joint arm with other actuators.
  std::string Model(const std::string& actuators) {
    std::string model = kTwoJointArm;
    const size_t begin = model.find("<actuator>"), end = model.find("</actuator>");
    model.replace(begin, end + 11 - begin, "<actuator>" + actuators + "</actuator>");
    model.replace(model.find(R"( ctrl="0.31 -0.41")"), 18, "");
    return folder.Write("arm", model);
  }

  Robot Bare(const std::string& actuators, std::optional<std::vector<CtrlMode>> modes = {}) {
    const Scene scene =
        Scene::Build(SceneWith({.path = Model(actuators), .control_modes = std::move(modes)}));
    return Robot::FromScene(scene, "base", "fore");
  }

  // Without a list of actuators.
  RobotConfig Config(const std::string& actuators, std::optional<ControlKind> control = {}) {
    RobotConfig config = ArmConfig(Model(actuators));
    config.move_groups.at("arm").actuators = {};
    if (control) config.control["arm"] = *control;
    return config;
  }

  ModelFolder folder;
};

std::vector<double> TorqueCommand(const Robot& robot) {
  const std::span<const double> port = robot.jnt_trq_cmd();
  return {port.begin(), port.end()};
}

double DriftUnderGravityTorques(Robot& robot) {
  const Eigen::Vector3d start = robot.tcp_in_world().translation();
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    robot.GravityTorques(robot.jnt_trq_cmd());
    EXPECT_TRUE(robot.Step().ok());
  }
  return (robot.tcp_in_world().translation() - start).norm();
}

// The oracle is the arm that has motors alone.
TEST_F(MotorArms, PairsOfServosAreSwitchedOffForTorques) {
  std::vector<double> end[2];
  for (const char* actuators : {kPairs, kMotors}) {
    Robot robot = RobotAlone(Config(actuators, ControlKind::kJointTorque));
    EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
    robot.SetJointPos(std::array{0.3, -0.4});
    for (int i = 0; i < 100; ++i) {
      robot.Update();
      robot.jnt_trq_cmd()[0] = 3;
      robot.jnt_trq_cmd()[1] = -1;
      EXPECT_TRUE(robot.Step().ok());
    }
    end[actuators == kMotors] = robot.arm().joint_pos();
  }
  for (size_t joint = 0; joint < 2; ++joint) EXPECT_NEAR(end[0][joint], end[1][joint], 1e-9);
}

TEST_F(MotorArms, PairsOfServosBrakeTogetherInVelocityMode) {
  const Scene scene = Scene::Build(
      SceneWith({.config = Config(kPairs, ControlKind::kJointVelocity),
                 .control_modes = std::vector{CtrlMode::kPosition, CtrlMode::kVelocity}}));
  Robot robot = Robot::Of(scene, scene.compiled()->robots().front().name);
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kVelocity);
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    robot.jnt_vel_cmd()[0] = 0.2;
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.arm().joint_vel()[0], 0.2, 0.05) << "with the gravity of the arm";
  robot.set_ctrl_mode(CtrlMode::kPosition);
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kPosition);
}

TEST_F(MotorArms, AreDrivenByTorques) {
  Robot robot = Bare(kMotors);
  EXPECT_THAT(robot.arm().actuator_names(), ElementsAre("m1", "m2"));
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
  robot.set_ctrl_mode(CtrlMode::kTorque);
  EXPECT_LT(DriftUnderGravityTorques(robot), 1e-3);
  robot.SetJntTrqCmd(std::vector<double>{0.5, -0.25});
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
  robot.Update();
  EXPECT_NEAR(robot.jnt_trq_msr()[0], 0.5, 1e-12) << "through the gear";
  EXPECT_NEAR(robot.jnt_trq_msr()[1], -0.25, 1e-12);
}

TEST_F(MotorArms, HoldThemselvesUpWithoutACommand) {
  Robot robot = Bare(kMotors);
  const Eigen::Vector3d start = robot.tcp_in_world().translation();
  for (int i = 0; i < 100; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_LT((robot.tcp_in_world().translation() - start).norm(), 1e-3);
}

TEST_F(MotorArms, RejectPositionsAndNameTheirModes) {
  Robot robot = Bare(kMotors);
  ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kPosition); },
                             "group 'arm' cannot be driven to positions: 'm1' is a motor, no "
                             "position servo: drive it in ctrl_mode torque by jnt_trq_cmd, or give "
                             "the model position servos");
  ExpectThrow<ArgumentError>(
      [&] {
        robot.SetJntPosCmd(std::vector<double>{0.5, 0});
      },
      "group 'arm' has no jnt_pos_cmd: 'm1' is a motor, no position servo");
  ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kVelocity); },
                             "cannot be switched to velocity: the scene has no actuators for it: "
                             "add velocity to the control_modes of its RobotSpec");
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque) << "what is refused changes nothing";
  const std::vector<double> q(2);
  std::vector<double> ctrl(2);
  ExpectThrow<ArgumentError>(
      [&] { robot.arm().CtrlForJointPos(q, ctrl); },
      "actuator 'm1' is not a position servo of one of its joints but a motor, so it cannot be "
      "driven "
      "to a joint position; give the group another controller (for an arm of motors: `control: "
      "{arm: joint_impedance}` at the top level of the robot file, or joint_torque there to "
      "command "
      "torques), or the model a servo");
}

TEST_F(MotorArms, GetTheDeclaredModes) {
  Robot robot = Bare(kMotors, std::vector{CtrlMode::kVelocity, CtrlMode::kTorque});
  EXPECT_EQ(robot.scene().model()->nu, 4);
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque) << "what the model has";
  EXPECT_THAT(robot.arm().actuator_names(), ElementsAre("m1", "m2"));
  EXPECT_LT(DriftUnderGravityTorques(robot), 1e-3);
  robot.set_ctrl_mode(CtrlMode::kVelocity);
  robot.set_ctrl_mode(CtrlMode::kTorque);
  EXPECT_LT(DriftUnderGravityTorques(robot), 1e-3) << "nothing is left of the velocity servos";
  EXPECT_EQ(Bare(kMotors).scene().model()->nu, 2) << "as authored";
  EXPECT_EQ(Bare(kMotors, std::vector{CtrlMode::kTorque}).scene().model()->nu, 2);
}

TEST_F(MotorArms, OfVelocityServosAreDrivenByVelocities) {
  for (const bool declared : {false, true}) {
    Robot robot = Bare(kVelocities,
                       declared ? std::optional(std::vector{CtrlMode::kVelocity, CtrlMode::kTorque})
                                : std::nullopt);
    EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kVelocity);
    EXPECT_THAT(robot.arm().actuator_names(), ElementsAre("v1", "v2"));
    robot.SetJntVelCmd(std::vector<double>{0.1, -0.2});
    for (int i = 0; i < 500; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
    robot.Update();
    EXPECT_NEAR(robot.jnt_vel_msr()[0], 0.1, 5e-3);
    EXPECT_NEAR(robot.jnt_vel_msr()[1], -0.2, 5e-3);
    if (declared) {
      robot.set_ctrl_mode(CtrlMode::kTorque);
      robot.arm().SetJointVel(std::vector<double>{0, 0});
      EXPECT_LT(DriftUnderGravityTorques(robot), 1e-3);
    } else {
      ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kTorque); },
                                 "add torque to the control_modes of its RobotSpec");
    }
    ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kPosition); },
                               "'v1' is a velocity servo, no position servo");
  }
}

TEST_F(MotorArms, AreRejectedWithoutActuatorsInEveryMode) {
  for (const CtrlMode mode : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    Robot robot = Bare("");
    ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(mode); },
                               "it has no actuators: no position servo on its joints, no velocity "
                               "servo and no motor");
    ExpectThrow<NotFoundError>([&] { robot.ctrl_mode(); },
                               "group 'arm' has no controller: it has no actuators");
    ExpectThrow<NotFoundError>([&] { robot.jnt_pos_cmd(); }, "it has no actuators");
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
}

TEST_F(MotorArms, AreRejectedWithMixedActuatorsInEveryMode) {
  for (const CtrlMode mode : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    Robot robot = Bare(kHalf);
    ExpectThrow<ArgumentError>(
        [&] { robot.set_ctrl_mode(mode); },
        "1 of its joints has no position servo: elbow ('m2' on it is a motor)");
    ExpectThrow<NotFoundError>([&] { robot.ctrl_mode(); }, "1 of its joints has no position servo");
  }
  RobotConfig config = Config(kHalf);
  config.move_groups.at("arm").actuators = {"s1", "m2"};
  Robot robot = RobotAlone(config);
  ExpectThrow<NotFoundError>([&] { robot.controller("arm"); },
                             "'m2' is a motor, and others are added to actuators of one kind only. "
                             "Give the model position servos");
  ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kTorque); },
                             "cannot be switched to torque: 's1' is a position servo, and others "
                             "are added to actuators of one kind only. Give the model motors");
}

TEST_F(MotorArms, AreRejectedWithIntegratingServosInEveryMode) {
  for (const CtrlMode mode : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    Robot robot = Bare(kIntegrating, std::vector{CtrlMode::kPosition, CtrlMode::kTorque});
    ExpectThrow<ArgumentError>(
        [&] { robot.set_ctrl_mode(mode); },
        "it has no actuators: no position servo on its joints, no velocity servo and no motor: "
        "shoulder ('i1' on it is a servo that integrates its control)");
  }
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(Config(kIntegrating, ControlKind::kJointTorque)); },
      "`control` is joint_torque, but it has no actuators: no position servo on its joints, "
      "no velocity servo and no motor: shoulder ('i1' on it is a servo that integrates its "
      "control), elbow ('i2' on it is a servo that integrates its control); remove it there, or "
      "give the model motors or position servos");
  RobotConfig listed = Config(kIntegrating);
  listed.move_groups.at("arm").actuators = {"i1", "i2"};
  Robot robot = RobotAlone(listed);
  ExpectThrow<NotFoundError>([&] { robot.jnt_pos_cmd(); },
                             "has no controller: 'i1' is a servo that integrates its control");
  listed.control["arm"] = ControlKind::kJointTorque;
  ExpectThrow<ArgumentError>([&] { RobotAlone(listed); },
                             "cannot be switched to torque: 'i1' is a servo that integrates its "
                             "control, and others are added");
  listed.stiffness = 10;
  ExpectThrow<SpecError>([&] { RobotAlone(listed); }, "actuator 'i1' is none");
}

TEST_F(MotorArms, AreRejectedWithZeroGearByName) {
  const auto all = std::vector{CtrlMode::kVelocity, CtrlMode::kTorque};
  for (const CtrlMode mode : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    Robot robot = Bare(kWithoutGear, all);
    ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(mode); },
                               "1 of its joints has no motor: shoulder ('m1' on it is without "
                               "effect, as its gear is 0)");
  }
  RobotConfig config = Config(kWithoutGear);
  config.move_groups.at("arm").actuators = {"m1", "m2"};
  const Scene scene =
      Scene::Build(SceneWith({.name = "r", .config = config, .control_modes = all}));
  const mjModel* m = scene.model();
  for (int a = 0; a < m->nactuator; ++a) {
    EXPECT_TRUE(std::isfinite(m->actuator_gainprm[mjNGAIN * a]));
    EXPECT_TRUE(std::isfinite(m->actuator_biasprm[mjNBIAS * a + 2]));
  }
  Robot robot = Robot::Of(scene, "r");
  ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(CtrlMode::kTorque); },
                             "cannot be switched to torque: 'm1' is without effect, as its gear is "
                             "0, and others are added to actuators of one kind only. Give the "
                             "model motors");
  ExpectThrow<ArgumentError>(
      [&] {
        std::vector<double> ctrl(2);
        robot.arm().CtrlForJointPos(std::vector<double>(2), ctrl);
      },
      "actuator 'm1' is not a position servo of one of its joints but without effect, as its gear "
      "is "
      "0");
}

// The model already defines the list of actuators.
TEST_F(MotorArms, AreConfiguredWithoutAListOfActuators) {
  Robot torque = RobotAlone(Config(kMotors, ControlKind::kJointTorque));
  EXPECT_THAT(torque.arm().actuator_names(), ElementsAre("m1", "m2"));
  EXPECT_EQ(torque.ctrl_mode(), CtrlMode::kTorque);
  EXPECT_LT(DriftUnderGravityTorques(torque), 1e-3);
  Robot soft = RobotAlone(Config(kMotors, ControlKind::kJointImpedance));
  std::vector<double> q = soft.arm().joint_pos();
  q[0] += 0.2;
  soft.Apply({{"arm", GroupCommand::Joints(q)}});
  for (int i = 0; i < 1500; ++i) {
    soft.Update();
    EXPECT_TRUE(soft.Step().ok());
  }
  EXPECT_NEAR(soft.arm().joint_pos()[0], q[0], 5e-3);
  EXPECT_EQ(RobotAlone(Config(kVelocities, ControlKind::kJointVelocity)).ctrl_mode(),
            CtrlMode::kVelocity);
}

TEST_F(MotorArms, ErrorsNameTheConfigurationFields) {
  Robot robot = RobotAlone(Config(kMotors));
  const std::string what = ExpectThrow<NotFoundError>(
      [&] { robot.controller("arm"); },
      "group 'arm' has no controller: 'm1' is a motor, no position "
      "servo: write `control: {arm: joint_impedance}` at the top level of the robot file, or "
      "joint_torque there to command torques, or give the model position servos");
  EXPECT_THAT(what, Not(HasSubstr("RobotSpec")));
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(Config(kVelocities, ControlKind::kJointPosition)); },
      "cannot be driven to positions: 'v1' is a velocity servo, no position servo: write "
      "`control: {arm: joint_impedance}` at the top level of the robot file, or joint_velocity "
      "there "
      "to command velocities, or give the model position servos");
  ExpectThrow<ArgumentError>([&] { RobotAlone(Config("", ControlKind::kJointTorque)); },
                             "remove it there, or give the model motors or position servos");
  robot.set_ctrl_mode(CtrlMode::kTorque);
  EXPECT_LT(DriftUnderGravityTorques(robot), 1e-3);
}

TEST_F(MotorArms, AreDrivenOnceByAnyNumberOfRobots) {
  Robot configured = RobotAlone(Config(kMotors));
  Robot bare = Robot::FromScene(configured.scene(), "base", "fore");
  bare.SetJntTrqCmd(std::vector<double>{0.5, 0.25});
  configured.SetController("arm", "joint_torque");
  configured.SetJntTrqCmd(std::vector<double>{1, 2});
  EXPECT_THAT(TorqueCommand(bare), ElementsAre(1, 2)) << "the same port";
  Robot first = RobotAlone(Config(kMotors));
  first.set_ctrl_mode(CtrlMode::kTorque);
  first.SetJntTrqCmd(std::vector<double>{3, 4});
  Robot later = Robot::FromScene(first.scene(), "base", "fore");
  EXPECT_THAT(TorqueCommand(later), ElementsAre(3, 4));
}

TEST_F(MotorArms, ErrorsOfObjectsNameNoRobotFields) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "lamp", .mjcf_path = Model(kMotors), .fixed = true});
  Scene scene = Scene::Build(spec);
  const std::string prefix = scene.compiled()->object("lamp").root_body.substr(
      0, scene.compiled()->object("lamp").root_body.size() - 4);
  Robot robot = Robot::FromScene(scene, "base", "fore", {.prefix = prefix});
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
  const std::string what = ExpectThrow<ArgumentError>(
      [&] { robot.set_ctrl_mode(CtrlMode::kVelocity); },
      "others are added only to robots, and this is not one. Add its model as one (RobotSpec) with "
      "velocity in its control_modes, or give it velocity servos");
  EXPECT_THAT(what, Not(HasSubstr("its RobotSpec")));
}

TEST_F(MotorArms, WarnAboutUnavailableModes) {
  const auto warnings = [&](const std::string& actuators, std::vector<CtrlMode> modes) {
    return Bare(actuators, std::move(modes)).scene().compiled()->warnings();
  };
  EXPECT_THAT(warnings(kIntegrating, {CtrlMode::kTorque}),
              ElementsAre(HasSubstr("control_modes has torque, but no arm of it has actuators that "
                                    "these can be added to")));
  EXPECT_THAT(warnings(kMotors, {CtrlMode::kTorque}), ElementsAre());
  EXPECT_THAT(warnings(kMotors, {CtrlMode::kPosition, CtrlMode::kVelocity}), ElementsAre());
  EXPECT_THAT(warnings("", {CtrlMode::kPosition}), ElementsAre());
}

}  // namespace
}  // namespace robocell::internal
