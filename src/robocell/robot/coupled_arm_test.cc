// Tests arms in which joints follow others, or actuators act through tendons: groups, states,
// controllers, torques, and the messages.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/scratch_robot.h"
#include "robocell/robot/testing/coupled_arms.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(CoupledArms, AreDrivenInTheirDegreesOfFreedom) {
  const Robot par = Parallelogram(), tele = Telescope(), diff = Differential();
  EXPECT_THAT(par.joint_names(), ElementsAre("j1", "j2", "j4", "j5", "j6"));
  EXPECT_THAT(par.group("arm").actuator_names(), ElementsAre("m1", "m2", "m3", "m4", "m5", "m6"));
  EXPECT_THAT(tele.joint_names(), ElementsAre("lift", "s1", "wy", "wp", "wr"));
  EXPECT_THAT(tele.group("arm").actuator_names(), ElementsAre("lift", "out", "wy", "wp", "wr"));
  EXPECT_EQ(diff.n_joints(), 6);
  EXPECT_THAT(Differential("").group("arm").actuator_names(),
              ElementsAre("m1", "m2", "m3", "m4", "da", "db"));
  for (const Robot* robot : {&par, &tele, &diff})
    EXPECT_EQ(robot->chain().joint_names(), robot->joint_names());
}

TEST_F(CoupledArms, NoteTheJointsThatFollow) {
  const Robot robot = Parallelogram();
  EXPECT_THAT(robot.scene().compiled()->notes(),
              Contains(HasSubstr("arm 'arm': 'j3' follows 'j2' by equality constraints")));
  EXPECT_THAT(Parallelogram("[j1, j2, j4, j5, j6]").joint_names(),
              ElementsAre("j1", "j2", "j4", "j5", "j6"));
}

TEST_F(CoupledArms, PutTheirFollowersInPlace) {
  Robot robot = Parallelogram();
  robot.SetJointPos(std::vector<double>{0.1, 0.5, 0.2, 0.3, 0.4});
  EXPECT_DOUBLE_EQ(Position(robot, "j3"), -0.5);
  const Pose tcp = robot.FkFrame(std::vector<double>{0.1, 0.5, 0.2, 0.3, 0.4});
  EXPECT_LT((robot.FkFrame().translation() - tcp.translation()).norm(), 1e-12);
  const Pose engine = robot.base_in_world().inverse() * robot.tcp_in_world();
  EXPECT_LT((engine.translation() - tcp.translation()).norm(), 1e-12);
  // The servo of the follower holds it.
  EXPECT_LT(Drift(robot, 500), 1e-4);
  Robot tele = Telescope();
  tele.SetJointPos(std::vector<double>{0.2, 0.1, 0, 0, 0});
  EXPECT_DOUBLE_EQ(Position(tele, "s3"), 0.1);
  EXPECT_LT(Drift(tele, 500), 1e-3);
}

TEST_F(CoupledArms, ReachCommandedConfigurations) {
  Robot par = Parallelogram(), tele = Telescope(), diff = Differential();
  EXPECT_LT(Reach(par, {0.5, 0.6, -0.4, 0.7, 0.3}), 2e-3);
  EXPECT_NEAR(Position(par, "j3"), -Position(par, "j2"), 2e-3);
  EXPECT_LT(Reach(tele, {0.4, 0.08, 0.5, -0.3, 0.6}), 2e-3);
  EXPECT_NEAR(Position(tele, "s3"), Position(tele, "s1"), 2e-3);
  EXPECT_LT(Reach(diff, {0.5, 0.4, -0.6, 0.3, 0.7, -0.9}), 2e-3);
}

TEST_F(CoupledArms, HaveTheLimitsThatTheirFollowersLeave) {
  const Robot robot = Parallelogram();
  EXPECT_EQ(robot.joint_limits()[1].lower, -1.2);  // j3 = -j2 is in -1.7 .. 1.2
  EXPECT_EQ(robot.joint_limits()[1].upper, 1.7);
  EXPECT_EQ(robot.chain().joints()[1].lower, -1.2);
  EXPECT_EQ(robot.chain().joints()[1].upper, 1.7);
}

TEST_F(CoupledArms, SolveInverseKinematicsWithoutBreakingTheCoupling) {
  Robot robot = Parallelogram();
  const std::vector<double> goal = {0.3, 0.7, -0.5, 0.9, 0.2};
  const Pose target = robot.FkFrame(goal);
  const IkResult found = robot.Ik(target);
  ASSERT_TRUE(found.success);
  EXPECT_LT(Reach(robot, std::vector<double>(found.q.begin(), found.q.end())), 2e-3);
  EXPECT_LT((robot.FkFrame().translation() - target.translation()).norm(), 2e-3);
}

TEST_F(CoupledArms, HaveTheGravityTorquesThatHoldThem) {
  RobotConfig config = Config(kParallelogramArm, "joints: j1..j6, leaf: {site: flange}");
  config.gravcomp = false;
  const Scene scene = Scene::Build(
      SceneWith({.name = "r", .config = config, .control_modes = std::vector{kPosition, kTorque}}));
  Robot robot = Robot::Of(scene, "r");
  robot.SetJointPos(std::vector<double>{0.1, 0.6, 0.2, 0.3, 0.4});
  robot.set_ctrl_mode(kTorque);
  EXPECT_LT(Drift({&robot}, 500, [](Robot& r) { r.GravityTorques(r.jnt_trq_cmd()); }), 2e-3);
  robot.Update();
  std::vector<double> gravity(5);
  robot.GravityTorques(gravity);
  EXPECT_NEAR(robot.jnt_trq_msr()[1], gravity[1], 0.05);
}

TEST_F(CoupledArms, BeginAtAHomeOfEitherLength) {
  RobotConfig config = Config(kParallelogramArm, "joints: j1..j6, leaf: {site: flange}");
  config.home["arm"] = {0.1, 0.4, -0.4, 0, 0.2, 0.3};
  Robot robot = Make(config);
  EXPECT_DOUBLE_EQ(Position(robot, "j3"), -0.4);
  EXPECT_LT(Drift(robot, 500), 1e-3);
  config.home["arm"] = {0.1, 0.4, 0.3, 0, 0.2, 0.3};
  const Robot other = Make(config);
  EXPECT_DOUBLE_EQ(Position(other, "j3"), -0.4);
  EXPECT_THAT(other.scene().compiled()->warnings(),
              Contains(HasSubstr("'j3' is 0.3, but it follows 'j2' and begins at -0.4")));
  RobotConfig leaders =
      Config(kParallelogramArm, "joints: [j1, j2, j4, j5, j6], leaf: {site: flange}");
  leaders.home["arm"] = {0.1, 0.4, 0, 0.2, 0.3};
  EXPECT_DOUBLE_EQ(Position(Make(leaders), "j3"), -0.4);
}

TEST_F(CoupledArms, MoveTheirFollowersInCollisionTests) {
  const Robot robot = Parallelogram();
  internal::ScratchRobot scratch(robot, 0.01, "");
  scratch.SetArm(std::vector<double>{0, 0.7, 0, 0, 0});
  const mjModel* m = scratch.model();
  EXPECT_DOUBLE_EQ(scratch.data()->qpos[m->jnt_qposadr[FindId(m, mjOBJ_JOINT, "j3")]], -0.7);
}

TEST_F(CoupledArms, SayWhatIsWrongWithTheirLists) {
  ExpectThrow<SpecError>([&] { Telescope("[lift, s1, s2, wy, wp]"); }, "'s2' follows 's1'");
  std::string singular = kDifferentialArm;
  singular.replace(singular.find("coef=\"-.5\""), 10, "coef=\".5\"");
  ExpectThrow<SpecError>(
      [&] {
        Make(Config(singular,
                    "joints: j1..j6, actuators: [m1, m2, m3, m4, da, db], leaf: {site: flange}"));
      },
      "its actuators move 5 of 6 joints: the matrix of their lengths is [[1, 0, 0, 0, 0, 0]");
  std::string circle = kParallelogramArm;
  circle.replace(circle.find("<equality>"), 10, "<equality><joint joint1='j2' joint2='j3'/>");
  ExpectThrow<ArgumentError>([&] { Make(Config(circle, "joints: j1..j6, leaf: {site: flange}")); },
                             "follow each other in a circle");
}

}  // namespace
}  // namespace robocell
