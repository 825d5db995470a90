#include "robocell/control/cartesian_impedance_controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/control/testing/tilted_arm.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

class CartesianImpedance : public ::testing::TestWithParam<RobotCase> {
 protected:
  Scene Build() { return TiltedScene(GetParam()); }
  Robot In(const Scene& scene) { return BentArm(scene, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Robots, CartesianImpedance, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(CartesianImpedance, TheTcpYieldsLikeASpringAlongTheAxesOfTheBase) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  soft.SetStiffness({500, 700, 900, 60, 60, 60});
  RunFor(robot, 200);
  const Pose start = robot.FkFrame();
  EXPECT_TRUE(start.is_close(soft.pose(), 3e-3, 1e-3)) << "it weighs nothing";
  const Vector3d force(5, -7, 9);  // exerted by the arm: it moves in this direction
  soft.SetFeedforward({force[0], force[1], force[2], 0, 0, 0});
  RunFor(robot, 1500);
  const Vector3d displacement = robot.FkFrame().translation() - start.translation();
  EXPECT_LT((displacement - Vector3d(0.01, -0.01, 0.01)).norm(), 1e-3);
  EXPECT_LT((start.inverse() * robot.FkFrame()).angle(), 0.01);
}

TEST_P(CartesianImpedance, RejectsANonFiniteFeedforwardByName) {
  REQUIRE_ROBOT(GetParam());
  Robot robot = In(Build());
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  ExpectThrow<ArgumentError>(
      [&] {
        soft.SetFeedforward({0, 0, std::nan(""), 0, 0, 0});
      },
      "value 2 of the feedforward is nan; all values must be finite");
}

TEST_P(CartesianImpedance, TheTcpReachesItsTargetWithoutOvershoot) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build();
  Robot robot = In(scene);
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  const Pose start = robot.FkFrame();
  const Vector3d step(0.03, -0.02, 0.02);
  soft.SetPose(Pose(start.translation() + step, start.rotation()));
  double farthest = 0;
  for (int i = 0; i < 2500; ++i) {  // damped joints of the model take their time
    RunFor(robot, 1);
    const Vector3d displacement = robot.FkFrame().translation() - start.translation();
    farthest = std::max(farthest, displacement.dot(step.normalized()));
  }
  EXPECT_LT(farthest, 1.1 * step.norm());
  const Pose off = soft.pose().inverse() * robot.FkFrame();
  EXPECT_LT(off.translation().norm(), 1e-3);
  EXPECT_LT(off.angle(), 5e-3);
}

TEST_P(CartesianImpedance, ThePostureDoesNotMoveTheTcp) {
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

TEST(CartesianImpedanceTarget, IsSetByPosesAndJoints) {
  Robot robot = RobotAlone(Rc7());
  std::vector<double> q = robot.arm().joint_pos();
  q[0] += 0.2;
  auto& soft = robot.SetController<CartesianImpedanceController>("arm");
  const Pose goal = robot.FkFrame() * Pose(Vector3d(0.01, 0, 0));
  robot.Apply({{"arm", GroupCommand::LeafPose(goal)}});
  EXPECT_TRUE(soft.pose().is_close(goal, 1e-12, 1e-12)) << "no inverse kinematics in between";
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  EXPECT_TRUE(soft.pose().is_close(robot.FkFrame(q), 1e-12, 1e-12));
  Scene scene = robot.scene();
  scene.Reset();
  EXPECT_TRUE(soft.pose().is_close(robot.FkFrame(), 1e-12, 1e-12))
      << "a reset holds the present pose";
}

TEST(CartesianImpedanceGains, AreChecked) {
  Robot robot = RobotAlone(Rc7());
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
}

TEST(CartesianImpedanceConfig, IsChosenInTheRobotsFile) {
  RobotConfig config = Rc7();
  config.control["arm"] = ControlKind::kCartesianImpedance;
  RobotSpec spec{.name = "rc7", .config = config, .control_modes = config.used_modes()};
  Robot robot = Robot::Of(Scene::Build(SceneWith(spec)), "rc7");
  EXPECT_EQ(robot.controller("arm").kind(), "cartesian_impedance");
  const Pose start = robot.FkFrame();
  RunFor(robot, 200);
  EXPECT_TRUE(robot.FkFrame().is_close(start, 2e-3, 1e-3));
}

}  // namespace
}  // namespace robocell
