// Tests that several robots made of one arm share its controller.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <optional>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAreArray;

constexpr CtrlMode kDriven = CtrlMode::kPosition, kPushed = CtrlMode::kTorque,
                   kTurned = CtrlMode::kVelocity;
const std::vector<double> kPush{0, 5, 0, -2, 0, 0.5, 0};

class SharedArm : public ::testing::TestWithParam<bool> {
 protected:
  static Scene Build() {
    RobotSpec spec{.name = "a", .config = Rc7()};
    spec.control_modes = std::vector{kDriven, kTurned, kPushed};
    return Scene::Build(SceneWith(spec));
  }
  static Robot AdHoc(const Scene& scene, bool tool) {
    ToolFrameSpec frame;
    if (tool) frame.tcp_site = "tcp";
    return Robot::FromScene(scene, "base_link", "link7", {.tool = frame});
  }
  // The second robot of the arm: the configured one, or another ad hoc.
  Robot Second(const Scene& scene) const {
    return GetParam() ? Robot::Of(scene, "a") : AdHoc(scene, true);
  }
  // Returns the torques of the motors after `robot` ran a tick.
  static std::vector<double> Pushed(Robot& robot) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
    robot.Update();
    return {robot.jnt_trq_msr().begin(), robot.jnt_trq_msr().end()};
  }
  static void ExpectPush(Robot& robot) {
    EXPECT_EQ(robot.ctrl_mode(), kPushed);
    const std::vector<double> pushed = Pushed(robot);
    for (size_t i = 0; i < kPush.size(); ++i) EXPECT_NEAR(pushed[i], kPush[i], 1e-9) << i;
  }
};
INSTANTIATE_TEST_SUITE_P(Second, SharedArm, ::testing::Bool(),
                         [](const auto& second) { return second.param ? "Configured" : "AdHoc"; });

TEST_P(SharedArm, AnotherRobotChangesNothing) {
  Scene scene = Build();
  Robot first = AdHoc(scene, false);
  first.set_ctrl_mode(kPushed);
  first.SetJntTrqCmd(kPush);
  ExpectPush(first);
  const int off = scene.model()->opt.disableactuator;
  Robot second = Second(scene);
  EXPECT_EQ(scene.model()->opt.disableactuator, off);
  ExpectPush(first);
  ExpectPush(second);
  EXPECT_THAT(second.jnt_trq_cmd(), ElementsAreArray(kPush));
  EXPECT_EQ(second.jnt_trq_cmd().data(), first.jnt_trq_cmd().data());
}

TEST_P(SharedArm, EitherRobotSwitchesItForBoth) {
  Scene scene = Build();
  Robot first = AdHoc(scene, false), second = Second(scene);
  for (Robot* one : {&first, &second}) {
    Robot& other = one == &first ? second : first;
    one->set_ctrl_mode(kPushed);
    one->SetJntTrqCmd(kPush);
    ExpectPush(other);
    other.set_ctrl_mode(kDriven);
    EXPECT_EQ(one->ctrl_mode(), kDriven);
    one->set_ctrl_mode(kPushed);
    EXPECT_EQ(other.ctrl_mode(), kPushed);
    EXPECT_EQ(one->controller("arm").kind(), "joint_torque");
    other.set_ctrl_mode(kDriven);
  }
}

TEST_P(SharedArm, TheLastCommandWinsWhicheverRobotUpdates) {
  Scene scene = Build();
  Robot first = AdHoc(scene, false), second = Second(scene);
  const std::vector<double> here(first.jnt_pos_msr().begin(), first.jnt_pos_msr().end());
  std::vector<double> target = here;
  target[0] += 0.2;
  first.SetJntPosCmd(target);
  for (int i = 0; i < 500; ++i) {
    first.Update();
    second.Update();
    ASSERT_TRUE(second.Step().ok());
  }
  EXPECT_NEAR(second.arm().joint_pos()[0], target[0], 0.02);
  second.SetJntPosCmd(here);
  for (int i = 0; i < 500; ++i) {
    first.Update();
    ASSERT_TRUE(first.Step().ok());
  }
  EXPECT_NEAR(first.arm().joint_pos()[0], here[0], 0.02);
}

TEST_P(SharedArm, RebuildsKeepModeAndTargetsAndResetsKeepTheMode) {
  Scene scene = Build();
  Robot first = AdHoc(scene, false), second = Second(scene);
  second.set_ctrl_mode(kPushed);
  first.SetJntTrqCmd(kPush);
  scene.AddObject(BoxObject("cube", {0.9, 0.9, 0.02}));
  ExpectPush(first);
  ExpectPush(second);
  scene.RemoveObject("cube");
  ExpectPush(second);
  ExpectPush(first);
  scene.Reset();
  EXPECT_EQ(first.ctrl_mode(), kPushed);
  std::vector<double> gravity(7);
  first.GravityTorques(gravity);
  EXPECT_THAT(second.jnt_trq_cmd(), ElementsAreArray(gravity));
}

TEST_P(SharedArm, KeepsItsControllerAfterTheRobotThatSetItIsGone) {
  Scene scene = Build();
  std::optional<Robot> first = AdHoc(scene, false);
  first->set_ctrl_mode(kPushed);
  first->SetJntTrqCmd(kPush);
  Robot second = Second(scene);
  first.reset();
  ExpectPush(second);
  scene.AddObject(BoxObject("cube", {0.9, 0.9, 0.02}));
  ExpectPush(second);
}

TEST_P(SharedArm, KeepsItsModeWithoutARobot) {
  Scene scene = Build();
  AdHoc(scene, false).set_ctrl_mode(kPushed);
  Robot next = Second(scene);
  EXPECT_EQ(next.ctrl_mode(), kPushed);
  EXPECT_EQ(next.controller("arm").kind(), "joint_torque");
  std::vector<double> gravity(7);
  next.GravityTorques(gravity);
  EXPECT_THAT(next.jnt_trq_cmd(), ElementsAreArray(gravity));
}

// A pointer on the flange: the tip of the robot that installs a controller.
class PointedArm : public SharedArm {
 protected:
  // Makes the robot that chooses the controller before or after the other robot of the arm.
  void Make(bool first_before) {
    scene.AddObject(pointer);
    const auto make_first = [&] {
      first = Robot::FromScene(scene, "base_link", "link7", {.tool = {.tcp_site = "pointer_tip"}});
    };
    if (first_before) make_first();
    second = Second(scene);
    if (!first_before) make_first();
  }

  ModelFolder folder;
  SceneObject pointer{.name = "pointer",
                      .mjcf_path = folder.Write("pointer", R"(<worldbody><body name="rod">
      <geom type="capsule" size="0.01 0.05" mass="0.3"/><site name="tip" pos="0 0 0.05"/>
      </body></worldbody>)"),
                      .attach_to = Body("link7"),
                      .pos = Vec3{0, 0, 0.3},
                      .fixed = true};
  Scene scene = Build();
  std::optional<Robot> first, second;
};
INSTANTIATE_TEST_SUITE_P(Second, PointedArm, ::testing::Bool(),
                         [](const auto& second) { return second.param ? "Configured" : "AdHoc"; });

TEST_P(PointedArm, FollowsTheOtherRobotAfterItsTipIsRemoved) {
  for (const bool before : {true, false}) {
    Make(before);
    first->SetController("arm", "cartesian_impedance");
    scene.RemoveObject("pointer");
    EXPECT_EQ(second->controller("arm").kind(), "joint_torque");
    EXPECT_EQ(second->ctrl_mode(), kPushed) << "no servo jumps in";
    std::vector<double> gravity(7);
    second->GravityTorques(gravity);
    EXPECT_THAT(second->jnt_trq_cmd(), ElementsAreArray(gravity)) << "it holds itself up";
    const std::vector<double> pushed = Pushed(*second);
    for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(pushed[i], gravity[i], 1e-9) << i;
    ExpectThrow<ClosedError>([&] { first->Update(); }, "went with an object that was removed");
    scene.AddObject(pointer);
    first->Update();
    EXPECT_EQ(first->controller("arm").kind(), "joint_torque") << "of the other robot";
    scene.RemoveObject("pointer");
    second->set_ctrl_mode(kDriven);
  }
}

TEST_P(PointedArm, KeepsItsTargetAfterItsTipIsRemoved) {
  for (const bool before : {true, false}) {
    for (const bool handle : {true, false}) {
      Make(before);
      std::vector<double> target(second->jnt_pos_msr().begin(), second->jnt_pos_msr().end());
      target[0] += 0.2;
      first->SetController("arm", "joint_position");  // made for its group
      first->SetJntPosCmd(target);
      if (!handle) first.reset();
      scene.RemoveObject("pointer");
      EXPECT_THAT(second->jnt_pos_cmd(), ElementsAreArray(target));
      for (int i = 0; i < 500; ++i) {
        second->Update();
        ASSERT_TRUE(second->Step().ok());
      }
      EXPECT_NEAR(second->arm().joint_pos()[0], target[0], 0.02);
      scene.Reset();
    }
  }
}

// The first four of seven joints.
Robot PartOf(const Scene& scene) { return Robot::FromScene(scene, "base_link", "link4"); }

TEST(PartOfAnArm, IsMeasuredButNotDriven) {
  const Scene scene = Scene::Build(SceneWith({.name = "a", .config = Rc7()}));
  Robot arm = Robot::Of(scene, "a"), part = PartOf(scene);
  const std::string why =
      "servo1 ... servo4 are driven by robot 'a' / group 'arm' already, an arm of other joints "
      "(joint1 ... joint7), and an actuator is driven by one arm alone. Command that one, or make "
      "a robot of the same joints, which shares what drives them";
  ExpectThrow<NotFoundError>([&] { part.jnt_pos_cmd(); }, "group 'arm' has no controller: " + why);
  ExpectThrow<ArgumentError>([&] { part.set_ctrl_mode(kDriven); }, why);
  ExpectThrow<ArgumentError>([&] { part.SetController("arm", "joint_position"); }, why);
  std::vector<double> target(arm.jnt_pos_msr().begin(), arm.jnt_pos_msr().end());
  target[0] += 0.3;
  arm.SetJntPosCmd(target);
  for (int i = 0; i < 500; ++i) {
    arm.Update();
    part.Update();  // would hold its joints where they were
    ASSERT_TRUE(arm.Step().ok());
  }
  part.Update();
  EXPECT_NEAR(part.jnt_pos_msr()[0], target[0], 0.02);
  EXPECT_TRUE(
      (part.base_in_world() * part.FkFrame()).is_close(scene.body_pose("link4"), 1e-9, 1e-9));
}

TEST(PartOfAnArm, IsDrivenWhileItExistsFirst) {
  const Scene scene = Scene::Build(SceneWith({.name = "a", .config = Rc7()}));
  std::optional<Robot> part = PartOf(scene);
  part->SetJntPosCmd(std::vector<double>{0.1, 0.2, 0.3, 0.4});
  Robot whole = Robot::FromScene(scene, "base_link", "link7");
  const std::string why = "servo1 ... servo4 are driven by robot 'a' / group 'arm' already";
  ExpectThrow<NotFoundError>([&] { whole.jnt_pos_cmd(); }, why);
  ExpectThrow<ArgumentError>([&] { Robot::Of(scene, "a"); }, why);
  whole.Update();
  part->Update();
  EXPECT_EQ(scene.actuator_ctrl("servo4"), 0.4);
  part.reset();
  whole.set_ctrl_mode(kDriven);
  EXPECT_EQ(whole.jnt_pos_cmd().size(), 7);
  EXPECT_EQ(Robot::Of(scene, "a").jnt_pos_cmd().data(), whole.jnt_pos_cmd().data());
  ExpectThrow<NotFoundError>([&] { PartOf(scene).jnt_pos_cmd(); }, "'arm' already");
}

TEST(PartOfAnArm, DisjointArmsAreBothDriven) {
  SceneSpec spec = SceneWith({.name = "a", .config = Rc7(), .prefix = "a_"});
  spec.robots.push_back({.name = "b", .config = Rc7(), .prefix = "b_", .pos = {0, 2, 0}});
  const Scene scene = Scene::Build(spec);
  Robot a = Robot::Of(scene, "a");
  Robot part = Robot::FromScene(scene, "base_link", "link4", {.prefix = "b_"});
  EXPECT_EQ(part.jnt_pos_cmd().size(), 4);
  EXPECT_EQ(a.jnt_pos_cmd().size(), 7);
}

TEST(ArmMode, IsSharedByAllRobotsOfTheActuators) {
  Robot robot = RobotAlone(Rc7());
  mjModel* m = robot.scene().mutable_model();
  const auto bit = [&](const char* actuator) {
    return 1 << m->actuator_group[RequireId(m, mjOBJ_ACTUATOR, actuator, "")];
  };
  m->opt.disableactuator = bit("servo1");
  EXPECT_EQ(robot.ctrl_mode(), kPushed);
  robot.set_ctrl_mode(kDriven);
  EXPECT_EQ(m->opt.disableactuator, bit("joint1_torque"));
  EXPECT_EQ(robot.ctrl_mode(), kDriven);
}

TEST(ArmPort, KeepsItsAddressThroughModeChanges) {
  Robot robot = RobotAlone(Rc7());
  const std::span<double> pos = robot.jnt_pos_cmd(), trq = robot.jnt_trq_cmd();
  robot.set_ctrl_mode(kPushed);
  EXPECT_EQ(robot.jnt_trq_cmd().data(), trq.data());
  trq[1] = 5;
  robot.set_ctrl_mode(kDriven);
  robot.SetController("arm", "relative_joint_position");
  robot.SetController("arm", "joint_position");
  EXPECT_EQ(robot.jnt_pos_cmd().data(), pos.data());
  pos[0] += 0.2;
  const double target = pos[0];
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_EQ(pos[0], target);
  EXPECT_NEAR(robot.arm().joint_pos()[0], target, 0.02);
}

TEST(ArmPort, CommandsWrittenBeforeTheModeApplyWithIt) {
  Robot robot = RobotAlone(Rc7());
  robot.SetJntTrqCmd(kPush);
  robot.Update();
  EXPECT_EQ(robot.ctrl_mode(), kDriven) << "only the port of the mode drives";
  robot.set_ctrl_mode(kPushed);
  EXPECT_THAT(robot.jnt_trq_cmd(), ElementsAreArray(kPush));
  const std::vector<double> here = robot.arm().joint_pos();
  robot.jnt_pos_cmd()[2] = 0.4;
  robot.set_ctrl_mode(kDriven);
  EXPECT_EQ(robot.jnt_pos_cmd()[2], 0.4);
  EXPECT_NEAR(robot.jnt_pos_cmd()[3], here[3], 0.1) << "where nothing was written, no jump";
  // Zeros are a command, too.
  robot.SetJntTrqCmd(std::vector<double>(7));
  robot.set_ctrl_mode(kPushed);
  EXPECT_THAT(robot.jnt_trq_cmd(), ElementsAreArray(std::vector<double>(7)));
}

TEST(ArmPort, OfAnotherModeIsClearedByAReset) {
  Robot robot = RobotAlone(Rc7());
  robot.SetJntTrqCmd(kPush);
  robot.scene().Reset();
  EXPECT_THAT(robot.jnt_trq_cmd(), ElementsAreArray(std::vector<double>(7)));
  robot.set_ctrl_mode(kPushed);
  std::vector<double> gravity(7);
  robot.GravityTorques(gravity);
  for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(robot.jnt_trq_cmd()[i], gravity[i], 1e-9);
}

TEST(ArmPort, TheReadingOfASensorOutlivesARebuild) {
  RobotConfig config = Rc7();
  config.attachments.push_back({.mjcf_path = "ft_sensor", .attach_to = Site("tcp")});
  config.ft_sensors = {{.name = "wrist_ft", .frame_site = "tcp"}};
  Robot robot = RobotAlone(config);
  Scene scene = robot.scene();
  scene.Forward();
  robot.Update();
  const Wrench& reading = robot.ft_sensor("wrist_ft");
  const Wrench before = reading;
  scene.AddObject(BoxObject("cube", {0.9, 0.9, 0.02}));
  EXPECT_EQ(reading.vector(), before.vector());
}

TEST(Paused, RobotStepsDoNotAdvanceTheScene) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  EXPECT_FALSE(robot.paused());
  robot.set_paused(true);
  EXPECT_TRUE(Robot::Of(scene, "rc7").paused());
  const std::vector<double> state = scene.state();
  EXPECT_TRUE(robot.Step().ok());
  EXPECT_TRUE(robot.StepN(10).ok());
  EXPECT_EQ(scene.state(), state);
  robot.jnt_pos_cmd()[0] += 0.1;
  robot.Update();
  EXPECT_NE(scene.state(), state) << "commands go on";
  EXPECT_TRUE(scene.Step().ok());
  EXPECT_GT(scene.time(), 0) << "the scene's own steps do";
  scene.Reset();
  EXPECT_TRUE(robot.paused());
  robot.set_paused(false);
  EXPECT_TRUE(robot.StepN(3).ok());
  EXPECT_NEAR(scene.time(), 3 * scene.timestep(), 1e-12);
}

}  // namespace
}  // namespace robocell::internal
