#include "robocell/hardware/arm_link.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/safety_gate.h"
#include "robocell/hardware/simulated_arm.h"
#include "robocell/hardware/testing/fake_arm.h"
#include "robocell/mujoco/step.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/gates.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

std::vector<double> List(std::span<const double> values) { return {values.begin(), values.end()}; }

// A robot, and an arm of the same kind in a scene of its own.
struct Linked {
  explicit Linked(ArmLinkOptions options = {}, SimulatedArmOptions arm_options = {})
      : robot(RobotAlone(Rc7())), scene(robot.scene()) {
    arm_options.real_time = false;
    arm = std::make_shared<SimulatedArm>(RobotAlone(Rc7()), arm_options);
    options.safety.slow_start = 0;
    link = std::make_unique<ArmLink>(robot, arm, options);
  }
  StepResult Run(int steps) {
    StepResult result;
    for (int i = 0; i < steps && result.ok(); ++i) {
      robot.Update();
      result = scene.Step();
    }
    return result;
  }
  Robot robot;
  Scene scene;
  std::shared_ptr<SimulatedArm> arm;
  std::unique_ptr<ArmLink> link;
};

TEST(ArmLink, DrivesTheArmAndMirrorsIt) {
  Linked cell;
  std::vector<double> goal = List(cell.robot.jnt_pos_msr());
  goal[1] += 0.3;
  cell.robot.SetJntPosCmd(goal);
  ASSERT_TRUE(cell.Run(800).ok());
  cell.robot.Update();
  const std::vector<double> twin = List(cell.robot.jnt_pos_msr());
  EXPECT_NEAR(twin[1], goal[1], 0.01);
  EXPECT_EQ(twin, cell.link->measured().pos);
  const std::vector<double> arm = List(cell.arm->robot().jnt_pos_msr());
  for (size_t i = 0; i < arm.size(); ++i) EXPECT_NEAR(twin[i], arm[i], 0.02);
  EXPECT_EQ(cell.link->state(), ArmState::kRunning);
}

// The same controller and targets, with and without an arm behind them.
TEST(ArmLink, LeavesControllersTheSame) {
  Linked cell;
  Robot simulated = RobotAlone(Rc7());
  Pose pose = cell.robot.FkFrame();
  pose = Pose(pose.translation() + Eigen::Vector3d(0, 0.05, 0), pose.rotation());
  for (Robot* robot : {&cell.robot, &simulated}) {
    robot->SetController("arm", "cartesian_pose");
    const Eigen::Quaterniond q(pose.rotation());
    const Eigen::Vector3d p = pose.translation();
    robot->controller("arm").SetTarget(
        std::vector{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
    for (int i = 0; i < 1500; ++i) {
      robot->Update();
      ASSERT_TRUE(robot->Step().ok());
    }
    EXPECT_LT((robot->FkFrame().translation() - pose.translation()).norm(), 0.005);
  }
}

TEST(ArmLink, MovesSlowerThanTheLimitsOfTheArm) {
  Linked cell({.safety = {.limits = {.velocity = std::vector<double>(7, 0.2)}}});
  cell.robot.jnt_pos_cmd()[0] += 1;
  double fastest = 0;
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(cell.Run(1).ok());
    fastest = std::max(fastest, std::abs(cell.link->command().vel[0]));
  }
  EXPECT_NEAR(fastest, 0.2, 1e-6);
}

// An arm without a body that has the joints of a robot.
std::shared_ptr<FakeArm> FakeOf(const Robot& robot) {
  std::vector<std::string> joints;
  for (const std::string& name : robot.joint_names()) joints.push_back(robot.OwnName(name));
  return std::make_shared<FakeArm>(joints);
}

TEST(ArmLink, StopsEveryStepWithTheReasonOnceTheArmIsSilent) {
  Robot robot = RobotAlone(Rc7());
  const auto arm = FakeOf(robot);
  ArmLink link(robot, arm);
  Scene scene = robot.scene();
  robot.jnt_pos_cmd()[0] += 0.5;
  for (int i = 0; i < 200; ++i) {
    robot.Update();
    ASSERT_TRUE(scene.Step().ok());
  }
  arm->speaks = false;  // unplugged
  StepResult result;
  for (int i = 0; i < 500 && result.ok(); ++i) robot.Update(), result = scene.Step();
  EXPECT_EQ(result.status, StepResult::kStopped);
  EXPECT_NE(result.message.find("no good measurement"), std::string::npos) << result.message;
  EXPECT_EQ(arm->held, 1);
  const int sent = arm->sent;
  EXPECT_EQ(scene.StepN(5).steps, 0);
  EXPECT_EQ(arm->sent, sent);
  EXPECT_FALSE(link.ok());
  link.Close();
  EXPECT_TRUE(scene.Step().ok()) << "then it is a simulation";
}

TEST(ArmLink, StopsForErrorsOfItsPortAndForControllersWithoutPositions) {
  struct Torn : ArmPort {
    explicit Torn(std::shared_ptr<SimulatedArm> of) : arm(std::move(of)) {}
    std::string name() const override { return "torn"; }
    std::vector<std::string> joint_names() const override { return arm->joint_names(); }
    ArmLimits limits() const override { return arm->limits(); }
    bool Read(ArmMeasurement& out) override { return arm->Read(out); }
    void Send(const ArmCommand& command) override {
      if (torn) throw IoError("the cable is torn");
      arm->Send(command);
    }
    void Hold() override { throw IoError("the cable is torn"); }
    double now() const override { return arm->now(); }
    void WaitUntil(double time) override { arm->WaitUntil(time); }
    std::shared_ptr<SimulatedArm> arm;
    bool torn = false;
  };
  Robot robot = RobotAlone(Rc7());
  const auto port = std::make_shared<Torn>(
      std::make_shared<SimulatedArm>(RobotAlone(Rc7()), SimulatedArmOptions{.real_time = false}));
  ArmLink link(robot, port);
  ASSERT_TRUE(robot.Step().ok());
  port->torn = true;
  const StepResult result = robot.StepN(20);
  EXPECT_EQ(result.status, StepResult::kStopped);
  EXPECT_NE(result.message.find("the cable is torn"), std::string::npos) << result.message;

  Linked cell;
  cell.robot.SetController("arm", "joint_impedance");
  EXPECT_NE(cell.Run(1).message.find("'joint_impedance' commands motors by itself"),
            std::string::npos);
}

TEST(ArmLink, AResetMovesNoArmAndBeginsWhereItIs) {
  Linked cell;
  cell.robot.jnt_pos_cmd()[0] += 0.4;
  ASSERT_TRUE(cell.Run(600).ok());
  const double before = cell.link->measured().pos[0];
  cell.scene.Reset({.seed = 3});
  EXPECT_EQ(List(cell.robot.jnt_pos_cmd()), cell.link->measured().pos);
  ASSERT_TRUE(cell.Run(300).ok());
  EXPECT_NEAR(cell.link->measured().pos[0], before, 0.02);
}

TEST(ArmLink, MirrorsWithoutSendingInADryRun) {
  Linked cell({.safety = {.dry_run = true}});
  cell.robot.jnt_pos_cmd()[0] += 0.4;
  const std::vector<double> begin = cell.link->measured().pos;
  ASSERT_TRUE(cell.Run(200).ok());
  EXPECT_NEAR(cell.link->measured().pos[0], begin[0], 1e-3);
  EXPECT_GT(cell.link->command().pos[0], begin[0] + 0.1) << "what would be sent";
  EXPECT_EQ(cell.link->counts().sent, 0);
}

TEST(ArmLink, TheGripperFollowsTheArmsAndItsCommandStays) {
  Linked cell;
  cell.robot.gripper().SetOpening(0);
  ASSERT_TRUE(cell.Run(800).ok());
  EXPECT_LT(cell.link->measured().opening, 0.1);
  EXPECT_NEAR(cell.robot.gripper().opening(), cell.link->measured().opening, 0.1);
  EXPECT_EQ(cell.robot.controller("gripper").target()[0], 0);
}

// Ends a motion, and expects that the arm brakes to rest within its acceleration, then holds.
void ExpectBraking(double acceleration, const std::function<void(ArmLink&, Scene&)>& end) {
  Robot robot = RobotAlone(Rc7());
  const auto arm = FakeOf(robot);
  for (double& each : arm->bounds.acceleration) each = acceleration;
  ArmLink link(robot, arm, {.safety = {.slow_start = 0, .max_lead = 10}});
  Scene scene = robot.scene();
  robot.jnt_pos_cmd()[0] += 2;
  while (std::abs(link.command().vel[0]) < 1) {
    robot.Update();
    ASSERT_TRUE(scene.Step().ok()) << link.reason();
  }
  const double speed = link.command().vel[0], from = arm->at.pos[0];
  end(link, scene);
  EXPECT_EQ(link.state(), ArmState::kStopped);
  EXPECT_NEAR(link.command().vel[0], 0, 1e-9);
  EXPECT_NEAR(arm->at.pos[0] - from, speed * speed / (2 * acceleration), 0.01);
  EXPECT_EQ(arm->held, 1);
}

TEST(ArmLink, BrakesAnArmThatMovesWhenItEnds) {
  ExpectBraking(10, [](ArmLink& link, Scene&) { link.Close(); });
  ExpectBraking(0.7, [](ArmLink& link, Scene& scene) {
    link.Stop("enough");
    EXPECT_EQ(scene.Step().status, StepResult::kStopped);
  });
  ExpectBraking(10, [](ArmLink& link, Scene&) {
    link.Stop("enough");  // a loop while ok() makes no further step
    link.Close();
    EXPECT_NE(link.reason().find("enough"), std::string::npos);
  });
}

TEST(ArmLink, BeginsWhereTheArmIsAtTheFirstStep) {
  Robot robot = RobotAlone(Rc7());
  const auto arm = FakeOf(robot);
  const ArmLink link(robot, arm, {.safety = {.slow_start = 0}});
  arm->clock += 3;  // the program loads a policy
  arm->at.pos[0] += 0.4;
  ASSERT_TRUE(robot.Step().ok()) << link.reason();
  EXPECT_NEAR(link.command().pos[0], 0.4, 1e-3);
}

TEST(ArmLink, KeepsTheSpeedWhenTheTimestepChanges) {
  Robot robot = RobotAlone(Rc7());
  const auto arm = FakeOf(robot);
  const ArmLink link(robot, arm, {.safety = {.slow_start = 0, .max_lead = 10}});
  Scene scene = robot.scene();
  scene.mutable_model()->opt.timestep /= 4;
  robot.jnt_pos_cmd()[0] += 2;
  double fastest = 0, before = arm->at.pos[0], clock = arm->clock;
  for (int i = 0; i < 400; ++i) {
    robot.Update();
    ASSERT_TRUE(scene.Step().ok());
    if (arm->clock <= clock) continue;
    fastest = std::max(fastest, std::abs(arm->at.pos[0] - before) / (arm->clock - clock));
    before = arm->at.pos[0], clock = arm->clock;
  }
  EXPECT_NEAR(fastest, 2, 1e-3);
}

TEST(ArmLink, CommandsJointsOnlyToControllersThatTakeThem) {
  Linked cell;
  std::vector<double> goal = List(cell.robot.jnt_pos_msr());
  cell.robot.SetController("arm", "cartesian_pose");
  ExpectThrow<ArgumentError>([&] { cell.link->MoveTo(goal, 1); }, "install 'joint_position' first");
  cell.robot.SetController("arm", "relative_joint_position");
  goal[0] += 0.1;
  EXPECT_TRUE(cell.link->MoveTo(goal, 5));
  ExpectThrow<ArgumentError>([&] { cell.link->MoveTo(std::vector{1.0}, 1); }, "got 1");
}

TEST(ArmLink, ArrivesAtATarget) {
  Linked cell;
  std::vector<double> goal = List(cell.robot.jnt_pos_msr());
  goal[0] += 0.2;
  EXPECT_TRUE(cell.link->MoveTo(goal, 5));
  cell.link->Stop("enough");
  EXPECT_FALSE(cell.link->MoveTo(goal, 5));
}

TEST(ArmLink, LetsAViewerHoldTheScene) {
  Linked cell;
  const auto viewer = GateForTests::Of(cell.scene, GateForTests::kHold);
  EXPECT_EQ(cell.scene.StepN(3).steps, 0);
  viewer->answer = GateForTests::kGo;
  EXPECT_EQ(cell.scene.StepN(3).steps, 3);
  EXPECT_EQ(viewer->ended, 3);
  EXPECT_EQ(viewer->good, 3);
  cell.link->Stop("enough");
  EXPECT_EQ(cell.scene.StepN(8).status, StepResult::kStopped);
  EXPECT_EQ(viewer->asked, 5);
  EXPECT_EQ(viewer->ended, 4) << "also for a step that the link stopped";
}

TEST(ArmLink, RefusesArmsThatAreNotTheRobots) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { const ArmLink link(robot, std::make_shared<FakeArm>()); },
                             "fake arm has the joints shoulder, elbow");
  ExpectThrow<ArgumentError>(
      [&] { const ArmLink link(robot, std::make_shared<SimulatedArm>(robot)); }, "one of its own");
  ExpectThrow<ArgumentError>([&] { const ArmLink link(robot, nullptr); }, "needs a port");
  const auto silent = FakeOf(robot);
  silent->speaks = false;
  ExpectThrow<IoError>([&] { const ArmLink link(robot, silent, {.timeout = std::nan("")}); },
                       "nothing good was measured");
  Linked cell;
  ExpectThrow<ArgumentError>([&] { const ArmLink link(cell.robot, cell.arm); }, "linked already");
  ExpectThrow<NotFoundError>([&] { const ArmLink link(robot, cell.arm, {.group = "leg"}); }, "leg");
}

}  // namespace
}  // namespace robocell
