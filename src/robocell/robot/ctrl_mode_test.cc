// Tests position, velocity and torque mode: holding, moving, inactive servos, and switching.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <optional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

RobotSpec Gen3With2F85(const std::string& prefix, const Vec3& pos) {
  return {.path = "menagerie:kinova_gen3/gen3.xml",
          .prefix = prefix,
          .pos = pos,
          .attachments = {{.mjcf_path = "menagerie:robotiq_2f85/2f85.xml",
                           .attach_to = Site("pinch_site"),
                           .prefix = "g_"}},
          .control_modes = std::vector{kPosition, kVelocity, kTorque}};
}

Robot Gen3In(const Scene& scene, const std::string& prefix) {
  return Robot::FromScene(
      scene, "base_link", "bracelet_link",
      {.prefix = prefix, .tool = {.tool_body = "g_base", .tcp_site = "g_pinch"}});
}

void CommandGravityTorques(Robot& robot) { robot.GravityTorques(robot.jnt_trq_cmd()); }

class Modes : public ::testing::TestWithParam<RobotCase> {
 protected:
  static RobotSpec Spec() {
    RobotSpec spec = GetParam().spec();
    spec.name = GetParam().name;
    spec.prefix = "r_";
    spec.control_modes = std::vector{kPosition, kVelocity, kTorque};
    if (spec.config) spec.config->gravcomp = false;
    return spec;
  }
  static Scene Build() { return Scene::Build(SceneWith(Spec())); }
  static Robot In(const Scene& scene) {
    Robot robot = GetParam().robot(scene, GetParam().name);
    if (GetParam().name != "fr3") return robot;
    robot.SetJointPos(InTheLimits());  // its reference is outside
    return robot;
  }
  static std::vector<double> InTheLimits() { return {0.2, 0.3, -0.2, -1.7, 0.2, 1.9, 0.4}; }
};
INSTANTIATE_TEST_SUITE_P(Robots, Modes, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(Modes, GravityTorquesHoldTheArm) {
  REQUIRE_ROBOT(GetParam());
  Robot robot = In(Build());
  robot.set_ctrl_mode(kTorque);
  EXPECT_LT(Drift({&robot}, 500, CommandGravityTorques), 1e-3);
}

TEST_P(Modes, SwitchingMovesNothingAndSurvivesAReset) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  Drift(robot, 1000);  // the servos settle
  for (const CtrlMode mode : {kTorque, kPosition, kVelocity, kPosition, kTorque, kVelocity}) {
    robot.set_ctrl_mode(mode);
    EXPECT_EQ(robot.ctrl_mode(), mode);
    EXPECT_LT(Drift(robot, 100), 1e-3) << ToString(mode);
  }
  scene.Reset();
  EXPECT_EQ(robot.ctrl_mode(), kVelocity);
  if (GetParam().name == "fr3") robot.SetJointPos(InTheLimits());
  EXPECT_LT(Drift(robot, 200), 2e-3);
}

TEST_P(Modes, VelocityModeTracksTheCommandedVelocity) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build();
  Robot robot = In(scene);
  robot.set_ctrl_mode(kVelocity);
  const double before = robot.jnt_pos_msr()[0];
  robot.jnt_vel_cmd()[0] = 0.3;
  Drift(robot, 500);
  robot.Update();
  EXPECT_NEAR(robot.jnt_pos_msr()[0] - before, 0.3 * 500 * scene.timestep(), 0.015);
  EXPECT_NEAR(robot.jnt_vel_msr()[0], 0.3, 3e-3);
}

TEST_P(Modes, EveryJointReachesItsVelocityWhileTheOthersRest) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build();
  Robot robot = In(scene);
  robot.set_ctrl_mode(kVelocity);
  for (const double sign : {1.0, -1.0}) {
    for (int i = 0; i < robot.n_joints(); ++i) robot.jnt_vel_cmd()[i] = i % 3 == 2 ? 0 : 0.1 * sign;
    Drift(robot, 500);
    robot.Update();
    for (int i = 0; i < robot.n_joints(); ++i)
      EXPECT_NEAR(robot.jnt_vel_msr()[i], robot.jnt_vel_cmd()[i], 1e-3) << "joint " << i;
  }
}

// Returns forces of the arm's actuators at which the joints keep their velocities.
std::vector<double> EngineTorques(const Robot& robot) {
  const Scene scene = robot.scene();
  mjData* d = scene.data();
  std::fill_n(d->qacc, scene.model()->nv, 0.0);
  mj_inverse(scene.model(), d);
  std::vector<double> torques;
  for (const ChainJoint& joint : robot.chain().joints())
    torques.push_back(d->qfrc_inverse[joint.dof_address]);
  return torques;
}

void ExpectTorques(const Robot& robot, const std::vector<double>& expected) {
  robot.scene().Forward();
  const std::vector<double> torques = robot.arm().joint_torque();
  for (size_t i = 0; i < torques.size(); ++i) EXPECT_NEAR(torques[i], expected[i], 1e-6) << i;
}

TEST_P(Modes, ForcesOfASteadyMotionDoNotJumpWhenSwitched) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build();
  Robot robot = In(scene);
  robot.RefreshToolInertia();
  robot.set_ctrl_mode(kTorque);
  robot.arm().SetJointVel(std::vector<double>{0.3, -0.2, 0.3, 0.2, -0.3, 0.2, 0.3});
  robot.SetJntTrqCmd(EngineTorques(robot));
  robot.Update();
  robot.scene().Forward();
  const std::vector<double> steady = robot.arm().joint_torque();
  for (const CtrlMode mode : {kVelocity, kPosition, kVelocity}) {
    SCOPED_TRACE(ToString(mode));
    robot.set_ctrl_mode(mode);
    ExpectTorques(robot, steady);
  }
}

TEST_P(Modes, AMovingArmSwitchedToVelocityModeBrakesWithoutACommand) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  robot.RefreshToolInertia();
  robot.set_ctrl_mode(kTorque);
  const std::vector<double> moving{0.3, -0.2, 0.3, 0.2, -0.3, 0.2, 0.3};
  robot.arm().SetJointVel(moving);
  scene.Forward();
  robot.set_ctrl_mode(kVelocity);
  robot.jnt_vel_cmd()[0] = moving[0];
  robot.Update();
  ExpectTorques(robot, EngineTorques(robot));
  const std::vector<double> start = robot.arm().joint_pos();
  Drift(robot, 1000);
  robot.Update();
  EXPECT_NEAR(robot.jnt_vel_msr()[0], moving[0], 3e-3);
  for (size_t i = 1; i < moving.size(); ++i) {
    EXPECT_NEAR(robot.jnt_vel_msr()[i], 0, 1e-3) << i;
    EXPECT_NEAR(robot.jnt_pos_msr()[i], start[i] + 0.1 * moving[i], 0.03) << i;
  }
}

// The same robot with a model that never had the arm's servos.
RobotSpec WithoutServos(RobotSpec spec, const std::vector<std::string>& servos) {
  if (!spec.config) spec.config = RobotConfig{.name = *spec.name, .model = spec.path};
  spec.path = "";
  spec.control_modes = std::nullopt;
  for (const std::string& servo : servos) {
    spec.config->edits.push_back(
        {.remove = ElementRef{.kind = ElementKind::kActuator, .name = servo}});
  }
  if (MoveGroupConfig* arm = spec.config->move_groups.find("arm")) arm->actuators = {};
  spec.config->control = {};
  return spec;
}

TEST_P(Modes, TorqueModeDisablesTheServos) {
  REQUIRE_ROBOT(GetParam());
  Robot with = In(Build());
  std::vector<std::string> servos = with.arm().actuator_names();
  for (std::string& servo : servos) servo.erase(0, with.prefix().size());
  RobotSpec spec = WithoutServos(Spec(), servos);
  Robot without = In(Scene::Build(SceneWith(spec)));
  EXPECT_EQ(without.arm().nu(), 0);
  with.set_ctrl_mode(kTorque);
  for (Robot* robot : {&with, &without})
    robot->arm().SetJointVel(std::vector<double>{0.5, -0.4, 0.3, 0.6, -0.7, 0.8, 2});
  with.SetJntTrqCmd(std::vector<double>(7, 0.0));
  for (int i = 0; i < 300; ++i) {
    with.Update();
    without.Update();
    ASSERT_TRUE(with.Step().ok() && without.Step().ok());
    for (int j = 0; j < 7; ++j) {
      ASSERT_NEAR(with.arm().joint_pos()[j], without.arm().joint_pos()[j], 1e-9)
          << "joint " << j << ", step " << i;
    }
  }
}

TEST(CtrlMode, GravityTorquesHoldTwoArmsWithGrippers) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  SceneSpec spec = SceneWith(Gen3With2F85("l_", {0, 0.6, 0}));
  spec.robots.push_back(Gen3With2F85("r_", {0, -0.6, 0}));
  const Scene scene = Scene::Build(spec);
  Robot left = Gen3In(scene, "l_"), right = Gen3In(scene, "r_");
  left.set_ctrl_mode(kTorque);
  EXPECT_EQ(right.ctrl_mode(), kPosition) << "each arm has its own mode";
  right.set_ctrl_mode(kTorque);
  EXPECT_LT(Drift({&left, &right}, 500, CommandGravityTorques), 1e-3);
}

TEST(CtrlMode, TheMeasuredTorqueIsTheMotorTorque) {
  Robot robot = RobotAlone(Rc7());
  robot.set_ctrl_mode(kTorque);
  const std::vector<double> torque{1, -2, 3, -4, 0.5, 0.25, -0.125};
  robot.SetJntTrqCmd(torque);
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
  robot.Update();
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(robot.jnt_trq_msr()[i], torque[i], 1e-12);
  robot.jnt_trq_cmd()[0] = 1000;
  robot.Update();
  EXPECT_TRUE(robot.Step().ok());
  robot.Update();
  EXPECT_EQ(robot.jnt_trq_msr()[0], 120) << "the servo's force limit";
}

TEST(CtrlMode, ForcesDoNotJumpWhenSwitched) {
  RobotConfig config = Rc7();
  config.gravcomp = false;
  Robot robot = RobotAlone(config);
  Scene scene = robot.scene();
  Drift(robot, 1000);
  for (const CtrlMode mode : {kTorque, kPosition, kTorque, kPosition}) {
    scene.Forward();
    const std::vector<double> before = robot.arm().joint_torque();
    robot.set_ctrl_mode(mode);
    scene.Forward();
    const std::vector<double> after = robot.arm().joint_torque();
    for (int i = 0; i < 7; ++i) EXPECT_NEAR(after[i], before[i], 1e-2) << ToString(mode);
    Drift(robot, 10);
  }
}

TEST(CtrlMode, ForcesOfAMovingArmDoNotJumpWhenSwitched) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  for (const CtrlMode mode : {kPosition, kTorque}) {
    robot.set_ctrl_mode(kTorque);
    robot.arm().SetJointVel(std::vector<double>{0.3, -0.2, 0.3, 0.2, -0.3, 0.2, 0.3});
    scene.Forward();
    const std::vector<double> before = robot.arm().joint_torque();
    robot.set_ctrl_mode(mode);
    scene.Forward();
    for (int i = 0; i < 7; ++i)
      EXPECT_NEAR(robot.arm().joint_torque()[i], before[i], 1e-6) << ToString(mode);
  }
}

// A servo holds against gravity because its target differs from its joint's position.
TEST(CtrlMode, ServosKeepHoldingTheArmWhenTheirControllerIsReplaced) {
  RobotConfig config = Rc7();
  config.gravcomp = false;
  Robot robot = RobotAlone(config);
  Drift(robot, 2000);
  const Eigen::Vector3d start = robot.tcp_in_world().translation();
  const std::vector<double> held = robot.arm().joint_torque();
  for (const char* kind : {"cartesian_pose", "differential_ik", "relative_joint_position",
                           "joint_position", "cartesian_pose", "joint_position"}) {
    robot.SetController("arm", kind);
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    for (int i = 0; i < 7; ++i)
      EXPECT_NEAR(robot.arm().joint_torque()[i], held[i], 1e-3) << kind << ", joint " << i;
    Drift(robot, 200);
    EXPECT_LT((robot.tcp_in_world().translation() - start).norm(), 1e-5) << kind;
  }
}

// After a reset they hold, with or without an update.
TEST(CtrlMode, ServosHoldingSinceAResetKeepHoldingWithANewController) {
  RobotConfig config = Rc7();
  config.gravcomp = false;
  Robot robot = RobotAlone(config);
  robot.scene().Reset();
  ASSERT_TRUE(robot.StepN(2000).ok());
  const Eigen::Vector3d start = robot.tcp_in_world().translation();
  robot.SetController("arm", "cartesian_pose");
  Drift(robot, 200);
  EXPECT_LT((robot.tcp_in_world().translation() - start).norm(), 1e-5);
}

TEST(CtrlMode, CommandsMustMatchTheController) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { robot.jnt_vel_cmd(); },
                             "group 'arm' has no jnt_vel_cmd: the scene has no actuators for it: "
                             "add velocity to the control_modes of its RobotSpec");
  robot.SetController("arm", "cartesian_pose");
  ExpectThrow<Error>([&] { robot.jnt_pos_cmd(); },
                     "group 'arm': there is no jnt_pos_cmd while its controller is "
                     "'cartesian_pose'; set ctrl_mode to position first");
  robot.set_ctrl_mode(kPosition);
  ExpectThrow<ArgumentError>(
      [&] {
        robot.Apply({{"arm", GroupCommand::Torques(std::vector<double>(7))}});
      },
      "its controller 'joint_position' takes joint positions, not joint torques");
  robot.set_ctrl_mode(kTorque);
  ExpectThrow<ArgumentError>([&] { robot.SetJntTrqCmd(std::vector<double>(3)); },
                             "group 'arm': expected 7 joint values, got 3");
  ExpectThrow<ArgumentError>(
      [&] {
        robot.Apply({{"arm", GroupCommand::Joints(std::vector<double>(7))}});
      },
      "its controller 'joint_torque' takes joint torques, not joint positions; command it with "
      "those, or choose another controller");
  // The error comes before inverse kinematics, so the reach does not matter.
  for (const double x : {0.3, 9.0}) {
    ExpectThrow<ArgumentError>(
        [&] {
          robot.Apply({{"arm", GroupCommand::LeafPose(Pose(Eigen::Vector3d(x, 0, 0.5)))}});
        },
        "its controller 'joint_torque' takes joint torques, not a pose; command it with those, or "
        "choose another controller");
  }
  const std::vector<double> torque{1, 2, 3, 4, 5, 6, 7};
  robot.Apply({{"arm", GroupCommand::Torques(torque)}});
  EXPECT_EQ(robot.jnt_trq_cmd()[6], 7);
  robot.jnt_trq_cmd()[2] = std::nan("");
  ExpectThrow<ArgumentError>([&] { robot.Update(); }, "the target of 'joint3' is nan");
}

TEST(CtrlMode, AChainRobotNamesTheRobotWithAGripper) {
  const Scene scene = Scene::Build(SceneWith({.name = "rc7", .config = Rc7()}));
  const Robot robot = Robot::FromScene(scene, "base_link", "link7");
  ExpectThrow<NotFoundError>(
      [&] { robot.gripper(); },
      "has no gripper group. Its groups: arm, base. It was made of a chain by Robot::FromScene (in "
      "Python Robot.from_scene), which makes an arm only: give the RobotSpec a `config` with this "
      "group, or drive its actuators by their names with Scene::SetActuatorCtrl (in Python "
      "Scene.set_actuator_ctrl)");
}

TEST(CtrlMode, ExplainsAMissingMode) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>(
      [&] { robot.set_ctrl_mode(kVelocity); },
      "robot 'rc7' / group 'arm' cannot be switched to velocity: the scene has no actuators for "
      "it: add velocity to the control_modes of its RobotSpec");
  EXPECT_EQ(robot.ctrl_mode(), kPosition);
  ExpectThrow<ArgumentError>(
      [&] { robot.SetController("gripper", "joint_torque"); },
      "group 'gripper': a gripper cannot have the controller 'joint_torque'");
  REQUIRE_MENAGERIE("kinova_gen3");
  const Scene whole = Scene::Build(SceneWith({.path = "menagerie:kinova_gen3/gen3.xml"}));
  Robot part = Robot::FromScene(whole, "base_link", "forearm_link");
  ExpectThrow<ArgumentError>([&] { part.set_ctrl_mode(kTorque); },
                             "its actuators are switched together with others ('joint_5_torque')");
}

TEST(CtrlMode, AFrozenModelCannotSwitchButCanStartInAnyMode) {
  RobotConfig config = Rc7();
  config.control["arm"] = ControlKind::kJointTorque;
  const auto compiled = CompileScene(SceneWith({.name = "rc7", .config = config}));
  compiled->Freeze();
  const Scene a = Scene::FromCompiled(compiled), b = Scene::FromCompiled(compiled);
  Robot first = Robot::Of(a, "rc7"), second = Robot::Of(b, "rc7");
  EXPECT_EQ(first.ctrl_mode(), kTorque);
  second.Update();
  ExpectThrow<Error>([&] { first.set_ctrl_mode(kPosition); }, "frozen");
  EXPECT_EQ(first.ctrl_mode(), kTorque);
}

SceneSpec SwitchableRc7() {
  return SceneWith({.name = "rc7",
                    .config = Rc7(),
                    .control_modes = std::vector{kPosition, kVelocity, kTorque}});
}

TEST(CtrlMode, IsNotInheritedByTheNextSceneOfAModel) {
  const auto compiled = CompileScene(SwitchableRc7());
  const int as_compiled = compiled->model()->opt.disableactuator;
  std::optional<Scene> scene = Scene::FromCompiled(compiled);
  Robot::Of(*scene, "rc7").set_ctrl_mode(kTorque);
  ExpectThrow<Error>([&] { compiled->Freeze(); },
                     "other scenes would begin so: robots were switched to other control modes");
  scene->Close();
  scene = Scene::FromCompiled(compiled);
  EXPECT_EQ(Robot::Of(*scene, "rc7").ctrl_mode(), kPosition);
  EXPECT_EQ(scene->model()->opt.disableactuator, as_compiled);
  Robot::Of(*scene, "rc7").set_ctrl_mode(kVelocity);
  scene.reset();
  compiled->Freeze();
  EXPECT_EQ(Robot::Of(Scene::FromCompiled(compiled), "rc7").ctrl_mode(), kPosition);
}

// A controller of motors that throws in Compute.
class CannotCompute : public Controller {
 public:
  explicit CannotCompute(const MoveGroup& group) : torque_(static_cast<size_t>(group.nv())) {}
  std::string_view kind() const override { return "cannot_compute"; }
  CtrlMode mode() const override { return kTorque; }
  TargetKind target_kind() const override { return TargetKind::kJointTorques; }
  int target_size() const override { return static_cast<int>(torque_.size()); }
  void SetTarget(std::span<const double>) override {}
  std::span<const double> target() const override { return port_; }
  std::span<const double> commanded_joint_pos() const override { return port_; }
  std::span<double> command_port() override { return port_; }
  bool UsePort(std::span<double> port) override {
    const std::span<double> to = port.empty() ? std::span<double>(torque_) : port;
    if (to.data() != port_.data()) std::copy(port_.begin(), port_.end(), to.begin());
    port_ = to;
    return true;
  }
  void Reset() override {}
  void Compute(std::span<double>) override { throw ArgumentError("no torque for this"); }

 private:
  std::vector<double> torque_;
  std::span<double> port_ = torque_;
};

TEST(CtrlMode, AFailedSwitchChangesNothing) {
  Scene scene = Scene::Build(SwitchableRc7()), twin = Scene::Build(SwitchableRc7());
  Robot robot = Robot::Of(scene, "rc7"), other = Robot::Of(twin, "rc7");
  for (Robot* r : {&robot, &other}) {
    r->jnt_pos_cmd()[1] += 0.3;
    r->jnt_vel_cmd()[0] = 0.2;  // for a later switch to velocity mode
  }
  Drift(robot, 20);
  Drift(other, 20);
  const Controller* before = &robot.controller("arm");
  ExpectThrow<ArgumentError>(
      [&] { robot.SetController("arm", std::make_unique<CannotCompute>(robot.arm())); },
      "no torque for this");
  EXPECT_EQ(&robot.controller("arm"), before);
  EXPECT_EQ(robot.ctrl_mode(), kPosition);
  EXPECT_EQ(scene.model()->opt.disableactuator, twin.model()->opt.disableactuator);
  const auto goes_on_as_its_twin = [&] {
    Drift(robot, 50);
    Drift(other, 50);
    EXPECT_EQ(scene.state(), twin.state());
  };
  goes_on_as_its_twin();
  robot.set_ctrl_mode(kVelocity);
  other.set_ctrl_mode(kVelocity);
  EXPECT_EQ(robot.jnt_vel_cmd()[0], 0.2);
  goes_on_as_its_twin();
  scene.Reset();
  twin.Reset();
  goes_on_as_its_twin();
}

// An arm of three joints whose hand has fingers `left` and `right`, with or without servos.
std::string ArmWithFingers(bool right, bool right_servo) {
  const auto link = [](int i, const std::string& inside) {
    return fmt::format(
        R"(<body name="link{0}" pos="0 0 0.2"><joint name="joint{0}" axis="0 {1} {2}"/>
           <geom type="capsule" fromto="0 0 0 0 0 0.2" size="0.03" mass="1"/>{3}</body>)",
        i, i > 1 ? 1 : 0, i > 1 ? 0 : 1, inside);
  };
  const auto finger = [](const std::string& name, double y) {
    return fmt::format(
        R"(<body name="{0}" pos="0 {1} 0.25"><joint name="{0}" type="slide" axis="0 1 0"/>
           <geom type="box" size="0.01 0.005 0.03" mass="0.05"/></body>)",
        name, y);
  };
  const auto servo = [](const std::string& joint, int kp) {
    return fmt::format(R"(<position joint="{0}" name="{0}" kp="{1}" kv="5"/>)", joint, kp);
  };
  const std::string fingers = finger("left", 0.03) + (right ? finger("right", -0.03) : "");
  return R"(<worldbody><body name="base">)" + link(1, link(2, link(3, fingers))) +
         "</body></worldbody><actuator>" + servo("joint1", 200) + servo("joint2", 200) +
         servo("joint3", 200) + servo("left", 400) + (right_servo ? servo("right", 400) : "") +
         "</actuator><equality>" +
         (right && !right_servo ? R"(<joint joint1="right" joint2="left" polycoef="0 -1 0 0 0"/>)"
                                : "") +
         "</equality>";
}

TEST(CtrlMode, SwitchingAnArmGivenByPathLeavesItsFingersAlone) {
  ModelFolder folder;
  for (const auto& [right, right_servo] : {std::pair{false, false}, {true, false}, {true, true}}) {
    const std::string model = folder.Write("hand", ArmWithFingers(right, right_servo));
    Scene scene = Scene::Build(SceneWith({.path = model}));
    Robot robot = Robot::FromScene(scene, "base", "link3");
    for (const CtrlMode mode : {kTorque, kPosition, kTorque}) {
      robot.set_ctrl_mode(mode);
      ASSERT_EQ(robot.ctrl_mode(), mode);
    }
    robot.SetJntTrqCmd(std::vector<double>(3));
    scene.SetActuatorCtrl("left", 0.02);
    if (right_servo) scene.SetActuatorCtrl("right", -0.02);
    robot.Update();
    scene.Forward();
    for (const double torque : robot.arm().joint_torque()) EXPECT_EQ(torque, 0) << "no servo's";
    const int left = RequireId(scene.model(), mjOBJ_JOINT, "left", "");
    EXPECT_NEAR(scene.data()->qfrc_actuator[scene.model()->jnt_dofadr[left]], 400 * 0.02, 1e-9);
    // With the finger it is an arm too.
    Scene other = Scene::Build(SceneWith({.path = model}));
    Robot whole = Robot::FromScene(other, "base", "left");
    if (right_servo) continue;  // fingers side by side are limbs of their own
    whole.set_ctrl_mode(kTorque);
    whole.SetJntTrqCmd(std::vector<double>(4));
    whole.Update();
    other.Forward();
    for (const double torque : whole.arm().joint_torque()) EXPECT_EQ(torque, 0);
  }
}

TEST(CtrlMode, WithFewActuatorGroupsFingersSwitchWithTheirArm) {
  ModelFolder folder;
  const std::string model = folder.Write("hand", ArmWithFingers(false, false));
  SceneSpec spec = EmptyScene();
  for (int i = 0; i < 14; ++i)  // 28 of 30 groups: one is left for two modes of the first
    spec.robots.push_back({.path = model, .prefix = "r" + std::to_string(i) + "_"});
  const Scene scene = Scene::Build(spec);
  Robot::FromScene(scene, "base", "link3", {.prefix = "r0_"}).set_ctrl_mode(kTorque);
  Robot::FromScene(scene, "base", "left", {.prefix = "r13_"}).set_ctrl_mode(kTorque);
  Robot last = Robot::FromScene(scene, "base", "link3", {.prefix = "r12_"});
  ExpectThrow<ArgumentError>([&] { last.set_ctrl_mode(kTorque); },
                             "its actuators are switched together with others ('r12_left_torque'); "
                             "give the robot a configuration with this arm as a move group");
}

TEST(CtrlMode, RejectsAModeWithoutAFreeActuatorGroup) {
  ModelFolder folder;
  const std::string arm = folder.Write("arm", kTwoJointArm);
  SceneSpec spec = EmptyScene();
  for (int i = 0; i < 16; ++i)
    spec.robots.push_back({.path = arm, .prefix = "r" + std::to_string(i) + "_"});
  const Scene scene = Scene::Build(spec);
  Robot fits = Robot::FromScene(scene, "base", "fore", {.prefix = "r14_"});
  fits.set_ctrl_mode(kTorque);
  Robot last = Robot::FromScene(scene, "base", "fore", {.prefix = "r15_"});
  ExpectThrow<ArgumentError>(
      [&] { last.set_ctrl_mode(kTorque); },
      "group 'arm' cannot be switched to torque: the arms before it took all 30 actuator groups "
      "that the engine can switch; set control_modes of robots that need no torque to [position]");
}

TEST(CtrlModes, RejectsInvalidValues) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { robot.set_ctrl_mode(static_cast<CtrlMode>(9)); },
                             "there is no control mode 9; expected one of position, velocity, "
                             "torque");
}

}  // namespace
}  // namespace robocell
