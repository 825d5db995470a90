// Tests robots as handles: making and finding them, shared state, groups, ports and life time.
#include "robocell/robot/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SceneSpec TwoRc7() {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = Rc7(), .prefix = "left_", .pos = {0, 0.6, 0}});
  spec.robots.push_back({.config = Rc7(), .prefix = "right/", .pos = {0, -0.6, 0}});
  return spec;
}

TEST(Robot, HasTheGroupsOfItsConfigurationAndABase) {
  Robot robot = RobotAlone(Rc7());
  EXPECT_EQ(robot.name(), "rc7");
  EXPECT_EQ(robot.config().name, "rc7");
  EXPECT_THAT(robot.group_names(), ElementsAre("arm", "gripper", "base"));
  EXPECT_EQ(&robot.arm(), &robot.group("arm"));
  EXPECT_EQ(&robot.gripper(), &robot.group("gripper"));
  EXPECT_EQ(&robot.base(), &robot.group("base"));
  EXPECT_EQ(robot.arm().actuator_names().size(), 7u);
  EXPECT_EQ(robot.joint_names().front(), "joint1");
  EXPECT_EQ(robot.joint_limits()[1].upper, 1.9);
}

TEST(Robot, IsFoundByNameWithSuggestions) {
  const Scene scene = Scene::Build(TwoRc7());
  EXPECT_EQ(Robot::Of(scene, "left").prefix(), "left_");
  EXPECT_EQ(RobotsOf(scene).size(), 2u);
  ExpectThrow<NotFoundError>(
      [&] { Robot::Of(scene, "lefft"); },
      "scene 'test': no robot 'lefft'. Its robots: left, right. Did you mean 'left'?");
}

TEST(Robot, NamesItsGroupsWhenOneIsMissing) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<NotFoundError>([&] { robot.group("gripperr"); },
                             "scene 'test' / robot 'rc7': no group 'gripperr'. Its groups: arm, "
                             "gripper, base. Did you mean 'gripper'?");
  ExpectThrow<NotFoundError>([&] { robot.controller("base"); },
                             "robot 'rc7' / group 'base' has no controller: it has no actuators");
  ExpectThrow<NotFoundError>([&] { robot.chain("gripper"); },
                             "group 'gripper' has no chain: kinematics need a configured group");
}

TEST(Robot, HandlesToOneRobotShareTheirState) {
  const Scene scene = Scene::Build(TwoRc7());
  Robot first = Robot::Of(scene, "left");
  Robot second = Robot::Of(scene, "left");
  first.jnt_pos_cmd()[2] = 0.25;
  EXPECT_EQ(second.jnt_pos_cmd()[2], 0.25);
  EXPECT_EQ(&first.arm(), &second.arm());
  EXPECT_NE(Robot::Of(scene, "right").jnt_pos_cmd()[2], 0.25);
}

TEST(Robot, TwoOfTheSameInOneSceneAreIndependent) {
  const Scene scene = Scene::Build(TwoRc7());
  Robot left = Robot::Of(scene, "left"), right = Robot::Of(scene, "right");
  EXPECT_EQ(right.arm().joint_names().front(), "right/joint1");
  const Pose right_tcp = right.tcp_in_world();
  EXPECT_NEAR(left.tcp_in_world().translation().y() - right_tcp.translation().y(), 1.2, 1e-9);
  std::vector<double> q = left.arm().joint_pos();
  q[0] += 0.5;
  left.Apply({{"arm", GroupCommand::Joints(q)}, {"gripper", GroupCommand::Opening(0)}});
  for (int i = 0; i < 500; ++i) {
    left.Update();
    right.Update();
    EXPECT_TRUE(left.Step().ok());
  }
  EXPECT_NEAR(left.arm().joint_pos()[0], q[0], 1e-3);
  EXPECT_LT(left.gripper().opening(), 0.01);
  EXPECT_GT(right.gripper().opening(), 0.99);
  EXPECT_TRUE(right.tcp_in_world().is_close(right_tcp, 1e-4, 1e-4));
}

TEST(Robot, OwnsTheBodiesAndGeomsOfItsSubtreeWithPedestalAndTools) {
  const Scene scene = Scene::Build(TwoRc7());
  const mjModel* m = scene.model();
  for (const Robot& robot : RobotsOf(scene)) {
    int bodies = 0, geoms = 0;
    for (const std::string& name : ElementNames(m, mjOBJ_BODY))
      bodies += name.starts_with(robot.prefix());
    for (const std::string& name : ElementNames(m, mjOBJ_GEOM))
      geoms += name.starts_with(robot.prefix());
    EXPECT_EQ(robot.body_ids().size(), static_cast<size_t>(bodies));
    EXPECT_EQ(robot.geom_ids().size(), static_cast<size_t>(geoms));
    EXPECT_EQ(robot.body_ids()[0], RequireId(m, mjOBJ_BODY, robot.prefix() + "mocap_base", ""));
    const int pedestal = RequireId(m, mjOBJ_GEOM, robot.prefix() + "pedestal", "");
    EXPECT_THAT(robot.geom_ids(), ::testing::Contains(pedestal));
  }
}

TEST(Robot, PortsAreReadAtUpdateAndDriveTheArm) {
  Robot robot = RobotAlone(Rc7());
  robot.jnt_pos_cmd()[3] += 0.1;
  const double target = robot.jnt_pos_cmd()[3];
  const double before = robot.jnt_pos_msr()[3];
  for (int i = 0; i < 1000; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  robot.Update();
  EXPECT_NEAR(robot.jnt_pos_msr()[3], target, 1e-6);
  EXPECT_NEAR(before, target - 0.1, 1e-12);
  EXPECT_EQ(std::vector<double>(robot.jnt_vel_msr().begin(), robot.jnt_vel_msr().end()),
            robot.arm().joint_vel());
  EXPECT_EQ(std::vector<double>(robot.jnt_trq_msr().begin(), robot.jnt_trq_msr().end()),
            robot.arm().joint_torque());
}

TEST(Robot, PortsRejectWrongSizesAtOnceAndInvalidNumbersAtUse) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { robot.SetJntPosCmd(std::vector<double>(3)); },
                             "robot 'rc7' / group 'arm': expected 7 joint values, got 3");
  robot.SetJntPosCmd(std::vector<double>(7, 0.1));
  EXPECT_EQ(robot.jnt_pos_cmd()[6], 0.1);
  robot.jnt_pos_cmd()[2] = std::nan("");
  const std::vector<double> ctrl = robot.arm().ctrl();
  ExpectThrow<ArgumentError>([&] { robot.Update(); },
                             "robot 'rc7' / group 'arm': the target of 'joint3' is nan; targets "
                             "must be finite");
  EXPECT_EQ(robot.arm().ctrl(), ctrl) << "nothing reached the engine";
}

TEST(Robot, SetJointPosTeleportsAndHolds) {
  Robot robot = RobotAlone(Rc7());
  const std::vector<double> q{0.3, 0.2, -0.1, 1.2, 0.4, 0.5, -1};
  robot.SetJointPos(q);
  EXPECT_EQ(robot.arm().joint_pos(), q);
  EXPECT_TRUE(robot.arm().leaf_frame_to_robot().is_close(robot.FkFrame(q), 1e-12, 1e-12));
  EXPECT_EQ(robot.jnt_pos_msr()[0], 0.3);
  for (int i = 0; i < 250; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(robot.arm().joint_pos()[i], q[i], 1e-6);
}

TEST(Robot, CanBeMadeFromTwoBodies) {
  const Scene scene = Scene::Build(SceneWith({.path = SourceDir() + "/models/robots/rc7/rc7.xml",
                                              .prefix = "r_",
                                              .base = BaseConfig{.kind = BaseKind::kMocap}}));
  Robot robot =
      Robot::FromScene(scene, "base_link", "link7",
                       {.prefix = "r_", .tool = {.tool_body = "hand", .tcp_site = "tcp"}});
  EXPECT_EQ(robot.name(), "r");
  EXPECT_THAT(robot.group_names(), ElementsAre("arm", "base"));
  EXPECT_EQ(robot.arm().actuator_names().back(), "r_servo7");
  EXPECT_EQ(robot.n_joints(), 7);
  for (int i = 0; i < 7; ++i) {
    const int joint = RequireId(scene.model(), mjOBJ_JOINT, "r_joint" + std::to_string(i + 1), "");
    EXPECT_EQ(robot.joint_names()[i], "r_joint" + std::to_string(i + 1));
    EXPECT_EQ(robot.joint_limits()[i].lower, scene.model()->jnt_range[2 * joint]);
    EXPECT_EQ(robot.joint_limits()[i].upper, scene.model()->jnt_range[2 * joint + 1]);
  }
  EXPECT_TRUE(robot.tcp_in_world().is_close(scene.site_pose("r_tcp"), 1e-12, 1e-12));
  robot.base().SetPose(Pose(Eigen::Vector3d(1, 2, 3)));
  EXPECT_NEAR(robot.base_in_world().translation().y(), 2, 1e-12);

  Robot bare = Robot::Of(scene, "r");
  EXPECT_THAT(bare.group_names(), ElementsAre("base"));
  EXPECT_TRUE(RobotsOf(scene).empty());
  ExpectThrow<NotFoundError>([&] { bare.arm(); },
                             "robot 'r': has no arm group. Its groups: base. Its "
                             "configuration has none: declare one under `move_groups`, or use "
                             "Robot::FromScene");
}

TEST(Robot, MadeFromTwoBodiesNamesAMissingBody) {
  const Scene scene = Scene::Build(SceneWith({.config = Rc7(), .prefix = "r_"}));
  ExpectThrow<NotFoundError>(
      [&] { Robot::FromScene(scene, "base_lnk", "link7", {.prefix = "r_"}); },
      "scene 'test': no body 'r_base_lnk'");
  ExpectThrow<NotFoundError>(
      [&] { Robot::FromScene(scene, "base_link", "link8", {.prefix = "r_"}); },
      "scene 'test': no body 'r_link8'");
  ExpectThrow<NotFoundError>(
      [&] {
        Robot::FromScene(scene, "base_link", "link7",
                         {.prefix = "r_", .tool = {.tcp_site = "tpc"}});
      },
      "scene 'test': no site 'r_tpc'");
  ExpectThrow<ArgumentError>(
      [&] { Robot::FromScene(scene, "link7", "base_link", {.prefix = "r_"}); }, "r_base_link");
}

TEST(Robot, RejectsArmJointsThatDoNotLeadToItsLeafFrame) {
  RobotConfig config = Rc7();
  config.move_groups.at("arm").joints = {"joint1", "joint3", "joint2"};
  config.move_groups.at("arm").actuators = {"servo1", "servo3", "servo2"};
  config.home = {};
  config.home_noise = {};
  ExpectThrow<SpecError>(
      [&] { RobotAlone(config); },
      "robot 'rc7': move_groups.arm.joints: lists joint1, joint3, joint2, but the joints from "
      "'base_link' to the arm's leaf are joint1 ... joint7; list those, in this order");
}

TEST(Robot, IsClosedWithItsScene) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  const MoveGroup& arm = robot.arm();
  const GripperGroup& gripper = robot.gripper();
  const Controller& controller = robot.controller("arm");
  scene.Close();
  ExpectThrow<ClosedError>([&] { robot.Update(); }, "robot 'rc7' is closed");
  ExpectThrow<ClosedError>([&] { EXPECT_TRUE(robot.Step().ok()); }, "scene 'test' is closed");
  ExpectThrow<ClosedError>([&] { arm.joint_pos(); }, "robot 'rc7' / group 'arm' is closed");
  ExpectThrow<ClosedError>([&] { gripper.opening(); }, "robot 'rc7' / group 'gripper' is closed");
  ExpectThrow<ClosedError>([&] { robot.arm(); }, "robot 'rc7' is closed: its scene was closed");
  ExpectThrow<ClosedError>([&] { robot.Apply({}); }, "robot 'rc7' is closed");
  ExpectThrow<ClosedError>([&] { robot.jnt_pos_msr(); }, "robot 'rc7' is closed");
  ExpectThrow<ClosedError>([&] { robot.jnt_pos_cmd(); }, "robot 'rc7' is closed");
  ExpectThrow<ClosedError>([&] { robot.ctrl_mode(); }, "robot 'rc7' is closed");
  ExpectThrow<ClosedError>([&] { controller.RequireOpen(); }, "group 'arm' is closed");
  ExpectThrow<ClosedError>([&] { robot.tcp_in_world(); }, "closed");
  ExpectThrow<ClosedError>([&] { robot.base_in_world(); }, "closed");
  ExpectThrow<ClosedError>([&] { Robot::Of(scene, "rc7"); }, "scene 'test' is closed");
  EXPECT_EQ(robot.name(), "rc7");
}

TEST(Robot, IsFreedWithItsSceneAndTheLastHandle) {
  std::weak_ptr<void> data;
  {
    std::optional<Robot> robot = RobotAlone(Rc7());
    data = robot->scene().data_keeper();
    EXPECT_FALSE(data.expired());
    EXPECT_EQ(robot->jnt_pos_msr().size(), 7u);
  }
  EXPECT_TRUE(data.expired()) << "scene and robot hold each other";
  const Scene scene = Scene::Build(SceneWith({.name = "rc7", .config = Rc7()}));
  Robot::Of(scene, "rc7").jnt_pos_cmd()[0] = 1;
  EXPECT_EQ(Robot::Of(scene, "rc7").jnt_pos_cmd()[0], 1) << "the scene keeps a robot's state";
}

TEST(Robot, ItsStateLivesAsLongAsAnyHandleOfTheScene) {
  SceneSpec spec = SceneWith({.name = "a", .config = Rc7(), .prefix = "a_"});
  spec.robots.push_back({.name = "b", .config = Rc7(), .prefix = "b_", .pos = {0, 2, 0}});
  std::optional<Robot> a = Robot::Of(Scene::Build(spec), "a");
  Robot::Of(a->scene(), "b").jnt_pos_cmd()[0] = 0.5;
  EXPECT_EQ(Robot::Of(a->scene(), "b").jnt_pos_cmd()[0], 0.5);
  const std::weak_ptr<void> data = a->scene().data_keeper();
  a.reset();
  EXPECT_TRUE(data.expired());
}

TEST(Robot, MadeFromTwoBodiesIsFreedWithItsHandle) {
  const Scene scene = Scene::Build(SceneWith({.config = Rc7(), .prefix = "r_"}));
  const auto make = [&] { return Robot::FromScene(scene, "base_link", "link7", {.prefix = "r_"}); };
  make().jnt_pos_cmd()[0] = 1;
  EXPECT_NE(make().jnt_pos_cmd()[0], 1);
}

// Returns the two-joint arm with a motor instead of its second servo.
std::string ArmWithOneServo() {
  std::string model = kTwoJointArm;
  const std::string servo = R"(<position name="servo2" joint="elbow" kp="50" kv="5"/>)";
  return model.replace(model.find(servo), servo.size(), R"(<motor name="push" joint="elbow"/>)");
}

TEST(Robot, RejectsAPartlyDrivenArm) {
  ModelFolder folder;
  RobotConfig config = ArmConfig(folder.Write("half", ArmWithOneServo()));
  config.move_groups.at("arm").actuators = {};
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config); },
      "robot 'arm' / group 'arm': 1 of its joints has no position servo: elbow ('push' on it "
      "is a motor). Name the `actuators` that move it, one for each joint, or leave those joints "
      "out");
  config.move_groups.at("arm").actuators = {"servo1", "push"};
  EXPECT_EQ(RobotAlone(config).arm().actuator_names().size(), 2u);
}

TEST(Robot, RejectsControlOfAnArmWithoutServos) {
  ModelFolder folder;
  std::string passive = kTwoJointArm;
  const size_t begin = passive.find("<actuator>"), end = passive.find("</actuator>");
  passive.erase(begin, end + 11 - begin);
  passive.replace(passive.find(R"( ctrl="0.31 -0.41")"), 18, "");
  RobotConfig config = ArmConfig(folder.Write("passive", passive));
  config.move_groups.at("arm").actuators = {};
  Robot robot = RobotAlone(config);
  robot.Update();
  ExpectThrow<NotFoundError>([&] { robot.controller("arm"); },
                             "has no controller: it has no actuators: no position servo on its");
  config.control["arm"] = ControlKind::kJointPosition;
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config); },
      "robot 'arm' / group 'arm': `control` is joint_position, but it has no actuators");
}

TEST(Robot, MadeFromTwoBodiesExplainsWhyItIsNotDriven) {
  ModelFolder folder;
  const Scene scene = Scene::Build(SceneWith({.path = folder.Write("half", ArmWithOneServo())}));
  Robot robot = Robot::FromScene(scene, "base", "fore");
  EXPECT_EQ(robot.n_joints(), 2);
  EXPECT_TRUE(robot.arm().actuator_names().empty());
  ExpectThrow<NotFoundError>([&] { robot.jnt_pos_cmd(); },
                             "has no controller: 1 of its joints has no position servo: elbow "
                             "('push' on it is a motor)");
}

TEST(Robot, AResetTakesTargetsFromThePoseOfTheHook) {
  const Scene built = Scene::Build(SceneWith({.name = "rc7", .config = Rc7()}));
  Scene scene = built;
  Robot robot = Robot::Of(scene, "rc7");
  const std::vector<double> q{0.3, 0.2, -0.1, 1.2, 0.4, 0.5, -1};
  const int hook = scene.AddResetHook([&](ResetContext&) { robot.arm().SetJointPos(q); });
  robot.jnt_pos_cmd()[0] = 2;
  scene.Reset();
  EXPECT_EQ(robot.jnt_pos_cmd()[0], 0.3);
  EXPECT_EQ(robot.jnt_pos_msr()[0], 0.3);
  for (int i = 0; i < 100; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.arm().joint_pos()[0], 0.3, 1e-6);
  scene.RemoveResetHook(hook);
  scene.Reset();
  EXPECT_EQ(robot.arm().joint_pos(), Rc7().home.at("arm"));
}

// Counts its resets, and throws a given text at each.
class ThrowsAtReset : public Controller {
 public:
  ThrowsAtReset(const MoveGroup& group, int* resets, std::string text)
      : resets_(resets), text_(std::move(text)), q_(group.joint_pos()) {}
  std::string_view kind() const override { return "throws_at_reset"; }
  int target_size() const override { return static_cast<int>(q_.size()); }
  void SetTarget(std::span<const double>) override {}
  std::span<const double> target() const override { return q_; }
  std::span<const double> commanded_joint_pos() const override { return q_; }
  std::span<double> command_port() override { return q_; }
  void Reset() override {
    ++*resets_;
    if (!text_.empty()) throw ArgumentError(text_);
  }
  void Compute(std::span<double> ctrl) override { std::fill(ctrl.begin(), ctrl.end(), 0.0); }

 private:
  int* resets_;
  std::string text_;
  std::vector<double> q_;
};

TEST(Robot, AnExceptionOfOneGroupAtAResetStopsNoOther) {
  Scene scene = Scene::Build(TwoRc7());
  Robot left = Robot::Of(scene, "left"), right = Robot::Of(scene, "right");
  std::array<int, 3> resets = {};
  left.SetController("arm", std::make_unique<ThrowsAtReset>(left.arm(), &resets[0], "not now"));
  left.SetController("gripper",
                     std::make_unique<ThrowsAtReset>(left.gripper(), &resets[1], "nor then"));
  right.SetController("gripper", std::make_unique<ThrowsAtReset>(right.gripper(), &resets[2], ""));
  right.jnt_pos_cmd()[0] = 2;
  resets = {};
  ExpectThrow<ArgumentError>([&] { scene.Reset(); }, "not now");
  EXPECT_THAT(resets, ElementsAre(1, 1, 1));
  EXPECT_EQ(right.jnt_pos_cmd()[0], right.arm().joint_pos()[0]);
}

// Returns qpos of every step of a motion of arm and gripper.
std::vector<double> Trajectory(Robot robot, uint64_t seed) {
  Scene scene = robot.scene();
  scene.Reset({.seed = seed});
  std::vector<double> out;
  for (int tick = 0; tick < 20; ++tick) {
    const double turn = 0.2 * std::sin(tick);
    robot.Apply({{"arm", GroupCommand::RelativeJoints({turn, 0, 0, turn, 0, 0, 0})},
                 {"gripper", GroupCommand::Opening(tick % 2)}});
    for (int i = 0; i < 20; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
      out.insert(out.end(), scene.data()->qpos, scene.data()->qpos + scene.model()->nq);
    }
  }
  return out;
}

TEST(Robot, TheSameCommandsAfterAResetGiveTheSameBits) {
  Robot robot = RobotAlone(Rc7());
  const std::vector<double> first = Trajectory(robot, 5);
  EXPECT_NE(Trajectory(robot, 6), first);
  EXPECT_EQ(Trajectory(robot, 5), first);
  EXPECT_EQ(Trajectory(RobotAlone(Rc7()), 5), first);
}

TEST(Robot, AfterAResetItsPortsMatchTheFinalForward) {
  Scene scene = Scene::Build(SceneWith({.name = "a", .config = Rc7()}));
  Robot robot = Robot::Of(scene, "a");
  scene.AddResetHook([](ResetContext& reset) {
    mjData* data = reset.scene.data();
    for (int i = 0; i < reset.scene.model()->nu; ++i) data->ctrl[i] += 0.1;
  });
  scene.Reset();
  const std::vector<double> torque = robot.arm().joint_torque();
  EXPECT_THAT(robot.jnt_trq_msr(), ::testing::ElementsAreArray(torque));
  EXPECT_THAT(robot.jnt_pos_msr(), ::testing::ElementsAreArray(robot.arm().joint_pos()));
  EXPECT_THAT(torque, ::testing::Contains(::testing::Ne(0)));
}

}  // namespace
}  // namespace robocell
