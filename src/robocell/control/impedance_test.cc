// Joint and Cartesian impedance: springs as stiff as they are told, no overshoot, no weight, and a
// posture that does not move the TCP.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/control/cartesian_impedance_controller.h"
#include "robocell/control/joint_impedance_controller.h"
#include "robocell/robot/joint_position_controller.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

void RunFor(Robot& robot, int steps) {
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
}

// Tilted, so that the base's axes are not the world's, and not compensated.
class Impedance : public ::testing::TestWithParam<RobotCase> {
 protected:
  Scene Build() {
    RobotSpec spec = GetParam().spec();
    spec.name = GetParam().name;
    spec.pos = {0, 0, 1};
    spec.euler = {25, -15, 60};
    if (spec.config) spec.config->gravcomp = false;
    Scene scene = Scene::Build(SceneWith(spec));
    mju_zero(scene.mutable_model()->dof_frictionloss, scene.model()->nv);  // it would stick
    return scene;
  }
  Robot In(const Scene& scene) {
    Robot robot = GetParam().robot(scene, GetParam().name);
    const std::vector<double> bent{0.2, 0.5, -0.3, GetParam().name == "panda" ? -1.6 : 1.2,
                                   0.2, 1.3, 0.4};
    if (GetParam().name != "fr3") robot.SetJointPos(bent);
    if (GetParam().name == "fr3")
      robot.SetJointPos(std::vector<double>{0.2, 0.3, -0.2, -1.7, 0.2, 1.9, 0.4});
    return robot;
  }
};
INSTANTIATE_TEST_SUITE_P(Robots, Impedance, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(Impedance, AJointGivesWayAsASpring) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& impedance = robot.SetController<JointImpedanceController>("arm");
  const std::vector<double> start = robot.arm().joint_pos();
  RunFor(robot, 200);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(robot.arm().joint_pos()[i], start[i], 2e-3) << "it weighs nothing";
  }
  const double push = 0.02 * impedance.stiffness()[3];
  scene.data()->qfrc_applied[robot.chain().joints()[3].dof_address] = push;
  RunFor(robot, 1500);
  EXPECT_NEAR(robot.arm().joint_pos()[3] - start[3], 0.02, 1e-3);
}

TEST_P(Impedance, TheLeafGivesWayAsASpringAlongTheAxesOfTheBase) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  soft.SetStiffness({500, 700, 900, 60, 60, 60});
  RunFor(robot, 200);
  const Pose start = robot.FkFrame();
  EXPECT_TRUE(start.is_close(soft.pose(), 3e-3, 1e-3)) << "it weighs nothing";
  const Vector3d force(5, -7, 9);  // pushed by the arm: it goes that way
  soft.SetFeedforward({force[0], force[1], force[2], 0, 0, 0});
  RunFor(robot, 1500);
  const Vector3d way = robot.FkFrame().translation() - start.translation();
  EXPECT_LT((way - Vector3d(0.01, -0.01, 0.01)).norm(), 1e-3);
  EXPECT_LT((start.inverse() * robot.FkFrame()).angle(), 0.01);
}

TEST_P(Impedance, AFeedforwardThatIsNoneIsToldByItsName) {
  REQUIRE_ROBOT(GetParam());
  Robot robot = In(Build());
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  ExpectThrow<ArgumentError>(
      [&] {
        soft.SetFeedforward({0, 0, std::nan(""), 0, 0, 0});
      },
      "value 2 of the feedforward is nan; all of it must be finite");
}

TEST_P(Impedance, TheLeafGoesToItsTargetWithoutOvershoot) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  const Pose start = robot.FkFrame();
  const Vector3d step(0.03, -0.02, 0.02);
  soft.SetPose(Pose(start.translation() + step, start.rotation()));
  double farthest = 0;
  for (int i = 0; i < 2500; ++i) {  // joints of the model that are damped take their time
    RunFor(robot, 1);
    const Vector3d way = robot.FkFrame().translation() - start.translation();
    farthest = std::max(farthest, way.dot(step.normalized()));
  }
  EXPECT_LT(farthest, 1.1 * step.norm());
  const Pose off = soft.pose().inverse() * robot.FkFrame();
  EXPECT_LT(off.translation().norm(), 1e-3);
  EXPECT_LT(off.angle(), 5e-3);
}

TEST_P(Impedance, TheLeafDoesNotFeelThePosture) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  RunFor(robot, 100);
  const Pose start = robot.FkFrame();
  const std::vector<double> before = robot.arm().joint_pos();
  std::vector<double> posture = before;
  posture[0] += 0.3;
  soft.SetPosture(posture);
  double error = 0;
  for (int i = 0; i < 1000; ++i) {
    RunFor(robot, 1);
    error = std::max(error, (robot.FkFrame().translation() - start.translation()).norm());
  }
  EXPECT_LT(error, 2e-3);
  EXPECT_GT(std::abs(robot.arm().joint_pos()[0] - before[0]), 5e-3) << "the elbow went";
}

TEST(ImpedanceTargets, AreCommandedByPortsAndActions) {
  Robot robot = RobotAlone(Rc7());
  robot.SetController<JointImpedanceController>("arm");
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
  robot.jnt_pos_cmd()[3] += 0.1;
  const double target = robot.jnt_pos_cmd()[3];
  RunFor(robot, 1000);
  EXPECT_NEAR(robot.arm().joint_pos()[3], target, 5e-3);
  std::vector<double> q = robot.arm().joint_pos();
  q[0] += 0.2;
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  EXPECT_EQ(robot.jnt_pos_cmd()[0], q[0]);

  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  const Pose goal = robot.FkFrame() * Pose(Vector3d(0.01, 0, 0));
  robot.Apply({{"arm", GroupCommand::LeafPose(goal)}});
  EXPECT_TRUE(soft.pose().is_close(goal, 1e-12, 1e-12)) << "no inverse kinematics in between";
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  EXPECT_TRUE(soft.pose().is_close(robot.FkFrame(q), 1e-12, 1e-12));
  robot.scene();
  Scene scene = robot.scene();
  scene.Reset();
  EXPECT_TRUE(soft.pose().is_close(robot.FkFrame(), 1e-12, 1e-12)) << "a reset holds what is there";
}

TEST(ImpedanceGains, AreChecked) {
  Robot robot = RobotAlone(Rc7());
  auto& impedance = robot.SetController<JointImpedanceController>("arm");
  impedance.SetStiffness(std::vector<double>{250});
  EXPECT_EQ(impedance.stiffness()[6], 250);
  ExpectThrow<ArgumentError>([&] { impedance.SetStiffness(std::vector<double>(3, 1)); },
                             "group 'arm': stiffness has 3 values; give 1 or 7");
  ExpectThrow<ArgumentError>([&] { impedance.SetDampingRatio(-1); },
                             "group 'arm': damping_ratio cannot be -1; it must be 0 or more");
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  ExpectThrow<ArgumentError>(
      [&] {
        soft.SetStiffness({1, 1, 1, 1, 1, std::nan("")});
      },
      "group 'arm': stiffness cannot be nan");
  ExpectThrow<ArgumentError>([&] { soft.SetTarget(std::vector<double>(6)); },
                             "group 'arm': expected 7 pose values, got 6");
  ExpectThrow<ArgumentError>(
      [&] {
        soft.SetTarget(std::vector<double>{0, 0, 0, 0, 0, 0, 2});
      },
      "group 'arm': the target pose: ");
  ExpectThrow<ArgumentError>([&] { robot.SetController("gripper", "joint_impedance"); },
                             "a gripper cannot have the controller 'joint_impedance'");
}

TEST(ImpedanceConfig, IsChosenInTheRobotsFile) {
  RobotConfig config = Rc7();
  config.control["arm"] = ControlKind::kCartesianImpedance;
  RobotSpec spec{.name = "rc7", .config = config, .control_modes = config.used_modes()};
  Robot robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  EXPECT_EQ(robot.controller("arm").kind(), "cartesian_impedance");
  const Pose start = robot.FkFrame();
  RunFor(robot, 200);
  EXPECT_TRUE(robot.FkFrame().is_close(start, 2e-3, 1e-3));
}

TEST(SetController, ByItsClassReturnsWhatIsPutIn) {
  Robot robot = RobotAlone(Rc7());
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  EXPECT_EQ(&soft, &robot.controller("arm"));
  EXPECT_EQ(robot.ctrl_mode(), CtrlMode::kTorque);
}

// A gripper's has the same name and another class.
TEST(SetController, ByAClassThatTheGroupHasNotChangesNothing) {
  Robot robot = RobotAlone(Rc7());
  const Controller* before = &robot.controller("gripper");
  ExpectThrow<ArgumentError>(
      [&] { robot.SetController<JointPositionController>("gripper"); },
      "group 'gripper': controller 'joint_position' is of another class here than was asked for; "
      "put it in by its name");
  EXPECT_EQ(&robot.controller("gripper"), before);
}

}  // namespace
}  // namespace robocell
