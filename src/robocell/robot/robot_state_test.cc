// Tests handles of every kind when objects of their scene are added and removed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAreArray;

// Objects come before robots in a model: the robots' ids and addresses move.
SceneObject Cube() { return BoxObject("cube", {0.9, 0.9, 0.02}); }

SceneSpec TwoRobots() {
  SceneSpec spec = SceneWith({.name = "a", .config = Rc7(), .prefix = "a_"});
  spec.robots.push_back({.name = "b",
                         .config = Rc7(),
                         .prefix = "b_",
                         .base = BaseConfig{.kind = BaseKind::kMocap},
                         .pos = {0, 1, 0}});
  return spec;
}

void RunBoth(Robot& a, Robot& b, int steps) {
  for (int i = 0; i < steps; ++i) {
    a.Update();
    b.Update();
    EXPECT_TRUE(a.Step().ok());
  }
}

TEST(Rebuild, HandlesOfEveryKindFollow) {
  Scene scene = Scene::Build(TwoRobots());
  Robot a = Robot::Of(scene, "a"), b = Robot::Of(scene, "b");
  Robot adhoc =
      Robot::FromScene(scene, "base_link", "link7", {.prefix = "b_", .tool = {.tcp_site = "tcp"}});
  MoveGroup& arm = a.arm();
  GripperGroup& gripper = b.gripper();
  BaseGroup& base = b.base();
  const std::span<double> port = a.jnt_pos_cmd();
  b.Apply({{"gripper", GroupCommand::Opening(1)}});
  RunBoth(a, b, 100);
  base.SetPose(Pose(Eigen::Vector3d(0.1, 1.2, 0)));
  const Pose tcp = a.tcp_in_world(), fk = b.FkFrame(), mocap = base.pose();
  const std::vector<double> q = arm.joint_pos(), ctrl = arm.ctrl(), torque = arm.joint_torque();
  const double opening = gripper.opening();
  for (int round = 0; round < 3; ++round) {
    scene.AddObject(Cube());
    EXPECT_THAT(arm.joint_pos(), ElementsAreArray(q));
    EXPECT_THAT(arm.ctrl(), ElementsAreArray(ctrl));
    for (size_t i = 0; i < torque.size(); ++i)
      EXPECT_NEAR(a.jnt_trq_msr()[i], torque[i], 1e-2 + 1e-2 * std::abs(torque[i]));
    EXPECT_TRUE(a.tcp_in_world().is_close(tcp, 1e-12, 1e-12));
    EXPECT_TRUE(b.FkFrame().is_close(fk, 1e-12, 1e-12));
    EXPECT_TRUE(adhoc.FkFrame().is_close(fk, 1e-12, 1e-12));
    EXPECT_TRUE(base.pose().is_close(mocap, 0, 0));
    EXPECT_NEAR(gripper.opening(), opening, 1e-12);
    EXPECT_EQ(ElementName(scene.model(), mjOBJ_BODY, a.body_ids().front()), "a_mocap_base");
    EXPECT_FALSE(a.collision_geom_ids().empty());
    scene.RemoveObject("cube");
    EXPECT_THAT(arm.joint_pos(), ElementsAreArray(q));
    EXPECT_TRUE(a.tcp_in_world().is_close(tcp, 1e-12, 1e-12));
  }
  EXPECT_EQ(a.jnt_pos_cmd().data(), port.data()) << "the port that was kept is no longer one";
  port[0] += 0.2;
  RunBoth(a, b, 500);
  EXPECT_NEAR(arm.joint_pos()[0], q[0] + 0.2, 0.02);
  EXPECT_EQ(Robot::Of(scene, "a").jnt_pos_cmd()[0], port[0]);
}

TEST(Rebuild, TargetsAndControlModesStay) {
  Scene scene = Scene::Build(TwoRobots());
  Robot a = Robot::Of(scene, "a"), b = Robot::Of(scene, "b");
  a.set_ctrl_mode(CtrlMode::kTorque);
  a.GravityTorques(a.jnt_trq_cmd());
  const std::vector<double> torques(a.jnt_trq_cmd().begin(), a.jnt_trq_cmd().end());
  b.jnt_pos_cmd()[2] = 0.3;
  RunBoth(a, b, 20);
  scene.AddObject(Cube());
  EXPECT_EQ(a.ctrl_mode(), CtrlMode::kTorque);
  EXPECT_EQ(b.ctrl_mode(), CtrlMode::kPosition);
  EXPECT_THAT(a.jnt_trq_cmd(), ElementsAreArray(torques));
  EXPECT_EQ(b.jnt_pos_cmd()[2], 0.3);
  RunBoth(a, b, 1);
  for (size_t i = 0; i < torques.size(); ++i) EXPECT_NEAR(a.jnt_trq_msr()[i], torques[i], 1e-9);
  scene.RemoveObject("cube");
  a.set_ctrl_mode(CtrlMode::kPosition);
  scene.AddObject(Cube());
  EXPECT_EQ(a.ctrl_mode(), CtrlMode::kPosition);
  scene.Reset();
  RunBoth(a, b, 10);
  EXPECT_EQ(a.ctrl_mode(), CtrlMode::kPosition);
}

// Each kind of robot is commanded to the pose that the hook sets, and stays there.
TEST(Rebuild, RobotsHoldThePoseOfTheHookAfterLaterResets) {
  Scene scene = Scene::Build(TwoRobots());
  Robot a = Robot::Of(scene, "a");
  Robot b =
      Robot::FromScene(scene, "base_link", "link7", {.prefix = "b_", .tool = {.tcp_site = "tcp"}});
  const std::vector<double> elsewhere(7, 0.1), pose{0.4, 0.3, -0.2, 1.1, 0.5, -0.6, 0.7};
  scene.AddResetHook([&](ResetContext&) {
    for (Robot* robot : {&a, &b}) robot->arm().SetJointPos(pose);  // not a command
  });
  const auto expect_held = [&](const char* when) {
    SCOPED_TRACE(when);
    for (Robot* robot : {&a, &b}) robot->SetJntPosCmd(elsewhere);
    RunBoth(a, b, 20);
    scene.Reset();
    for (Robot* robot : {&a, &b}) EXPECT_THAT(robot->jnt_pos_cmd(), ElementsAreArray(pose));
    for (int i = 0; i < 200; ++i) {
      RunBoth(a, b, 1);
      for (Robot* robot : {&a, &b}) {
        for (int j = 0; j < 7; ++j) ASSERT_NEAR(robot->jnt_pos_msr()[j], pose[j], 2e-3) << j;
      }
    }
  };
  scene.AddObject(Cube());
  expect_held("added");
  scene.RemoveObject("cube");
  expect_held("removed");
}

// The mode belongs to the model; it stays without any handle to the robot.
TEST(Rebuild, AControlModePersistsWithoutAHandle) {
  Scene scene = Scene::Build(TwoRobots());
  const auto tip = RobotOptions{.prefix = "b_", .tool = {.tcp_site = "tcp"}};
  Robot::Of(scene, "b").set_ctrl_mode(CtrlMode::kTorque);
  scene.ForgetKeptObservers();
  const auto off = [&](const char* actuator) {
    const mjModel* m = scene.model();
    const int group = m->actuator_group[RequireId(m, mjOBJ_ACTUATOR, actuator, "")];
    return (m->opt.disableactuator >> group & 1) != 0;
  };
  EXPECT_TRUE(off("b_servo1"));
  scene.AddObject(Cube());
  EXPECT_TRUE(off("b_servo1"));
  EXPECT_FALSE(off("b_joint1_torque"));
  EXPECT_FALSE(off("a_servo1"));
  EXPECT_TRUE(off("a_joint1_torque"));
}

TEST(Rebuild, AnObjectOnTheFlangeAddsToTheArm) {
  Scene scene = Scene::Build(SceneWith({.name = "a", .config = Rc7()}));
  Robot robot = Robot::Of(scene, "a");
  std::vector<double> bare(7), loaded(7);
  robot.GravityTorques(bare);
  SceneObject plate = BoxObject("plate", {0, 0, 0.02});
  plate.mass = 2;
  plate.fixed = true;
  plate.attach_to = {AttachKind::kBody, "link7"};
  scene.AddObject(plate);
  robot.GravityTorques(loaded);
  EXPECT_GT(std::abs(loaded[1] - bare[1]), 1);
  const size_t bodies = robot.body_ids().size();
  scene.RemoveObject("plate");
  EXPECT_EQ(robot.body_ids().size(), bodies - 1);
  robot.GravityTorques(loaded);
  EXPECT_THAT(loaded, ElementsAreArray(bare));
}

TEST(Rebuild, ARobotRemovedWithItsObjectReportsItAndReturns) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  const SceneObject door{.name = "door", .mjcf_path = folder.Write("door", R"(<worldbody>
      <body name="frame"><geom type="box" size="0.1 0.1 0.1"/><body name="leaf" pos="0.2 0 0">
      <joint name="hinge" axis="0 0 1"/><geom type="box" size="0.1 0.01 0.1"/></body></body>
      </worldbody>)")};
  spec.objects.push_back(door);
  Scene scene = Scene::Build(spec);
  Robot robot = Robot::FromScene(scene, "frame", "leaf", {.prefix = "door_"});
  const std::string name = robot.name();
  scene.RemoveObject("door");
  const std::string why = "robot '" + name +
                          "' went with an object that was removed from its scene; add the object "
                          "again, or make another robot: scene 'test' / robot '" +
                          name + "': no body 'door_frame'";
  ExpectThrow<ClosedError>([&] { robot.Update(); }, why);
  ExpectThrow<ClosedError>([&] { robot.FkFrame(); }, why);
  ExpectThrow<ClosedError>([&] { robot.base_in_world(); }, why);
  ExpectThrow<ClosedError>([&] { robot.arm(); }, why);
  EXPECT_TRUE(robot.body_ids().empty());
  EXPECT_TRUE(scene.Step().ok());
  scene.Reset();
  EXPECT_EQ(scene.time(), 0);
  ExpectThrow<ClosedError>([&] { robot.Update(); }, why);
  scene.AddObject(door);
  robot.Update();
  EXPECT_EQ(robot.n_joints(), 1);
  scene.data()->qpos[0] = 0.5;
  scene.Reset();
  EXPECT_EQ(robot.jnt_pos_msr()[0], 0);
}

}  // namespace
}  // namespace robocell::internal
