// Tests straight lines of the TCP within the speed and joint limits.
#include "robocell/control/cartesian_pose_controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

CartesianPoseController& Use(Robot& robot) {
  robot.SetController("arm", "cartesian_pose");
  return dynamic_cast<CartesianPoseController&>(robot.controller("arm"));
}

class CartesianPose : public ::testing::TestWithParam<RobotCase> {};
INSTANTIATE_TEST_SUITE_P(Robots, CartesianPose, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(CartesianPose, MovesStraightWithinItsSpeedLimit) {
  REQUIRE_ROBOT(GetParam());
  RobotSpec spec = GetParam().spec();
  spec.name = GetParam().name;
  const Scene scene = Scene::Build(SceneWith(spec));
  Robot robot = GetParam().robot(scene, GetParam().name);
  std::vector<double> bent = robot.arm().joint_pos();
  if (GetParam().name == "xarm7") bent = {0, 0.2, 0, 0.9, 0, 0.7, 0};
  if (GetParam().name == "fr3") bent = {0, 0.2, 0, -1.8, 0, 2, 0.8};
  robot.SetJointPos(bent);
  CartesianPoseController& cartesian = Use(robot);
  cartesian.SetMaxSpeeds(0.1, 0.5);
  const Pose start = robot.FkFrame(cartesian.commanded_joint_pos());
  const Pose goal = Pose(start.translation() + Vector3d(-0.05, 0.08, -0.06), start.rotation()) *
                    Pose::FromRotvec(Vector3d::Zero(), Vector3d(0.1, 0.15, 0));
  cartesian.SetPose(goal);
  const Vector3d direction = (goal.translation() - start.translation()).normalized();
  const double dt = scene.timestep();
  double off = 0, fastest = 0;
  Vector3d before = start.translation();
  for (int i = 0; i < 1200; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    const Pose now = robot.FkFrame(cartesian.commanded_joint_pos());
    const Vector3d moved = now.translation() - start.translation();
    off = std::max(off, (moved - moved.dot(direction) * direction).norm());
    fastest = std::max(fastest, (now.translation() - before).norm() / dt);
    before = now.translation();
  }
  EXPECT_LT(off, 1e-3);
  EXPECT_LT(fastest, 0.11);
  const Pose end = robot.FkFrame(cartesian.commanded_joint_pos());
  EXPECT_TRUE(end.is_close(goal, 1e-3, 1e-4));
}

TEST(CartesianPoseLimits, ApproachesATargetOutOfReachWithinTheJointLimits) {
  Robot robot = RobotAlone(Rc7());
  CartesianPoseController& cartesian = Use(robot);
  cartesian.SetMaxSpeeds(1, 3);
  const Pose start = robot.FkFrame();
  cartesian.SetPose(Pose(Vector3d(3, 0, 0.4), start.rotation()));
  for (int i = 0; i < 2000; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  for (int j = 0; j < 7; ++j) {
    const double q = cartesian.commanded_joint_pos()[j];
    EXPECT_GE(q, robot.joint_limits()[j].lower);
    EXPECT_LE(q, robot.joint_limits()[j].upper);
  }
  EXPECT_GT(robot.FkFrame().translation().x(), start.translation().x() + 0.1);
  cartesian.SetPose(start);
  for (int i = 0; i < 1000; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_TRUE(robot.FkFrame().is_close(start, 5e-3, 2e-3)) << "and it comes back at once";
}

// The target is off in what counts and far off in what does not; only the former is followed.
TEST(CartesianPoseTaskSpace, TurnsAndMovesOnlyInWhatCounts) {
  const double turn = 0.5, shift = 0.1;
  const Vector3d counted_shift(0.02, 0.03, -0.02);
  for (const Vec3& weights : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 0.1, 1}, Vec3{0.2, 1, 0},
                              Vec3{0, 0, 0}, Vec3{0.5, 2, 1}}) {
    RobotConfig config = Rc7();
    config.move_groups["arm"].task_space =
        TaskSpaceConfig{.position_weights = Vec3{1, 1, 0}, .rotation_weights = weights};
    Robot robot = RobotAlone(config);
    CartesianPoseController& cartesian = Use(robot);
    const Pose start = robot.FkFrame(cartesian.commanded_joint_pos());
    Vector3d turned(turn, -turn, 0.3);  // of the target about its axes
    Vector3d moved(counted_shift.x(), counted_shift.y(), shift);
    cartesian.SetPose(start * Pose::FromRotvec(moved, turned));
    for (int i = 0; i < 1500; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
    const Pose end = robot.FkFrame(cartesian.commanded_joint_pos());
    const Pose off = cartesian.pose().inverse() * end;
    EXPECT_NEAR(off.translation().x(), 0, 1e-3);
    EXPECT_NEAR(off.translation().y(), 0, 1e-3);
    EXPECT_GT(std::abs(off.translation().z()), 0.02) << "does not count";
    const auto zeros = std::ranges::count(weights, 0.0);
    const double angle = (start.inverse() * end).rotvec().norm();
    if (zeros == 2) {
      EXPECT_NEAR(off.rotvec().dot(ToEigen(weights)), 0, 2e-3);
      EXPECT_GT(off.rotvec().norm(), 0.2) << "the rest of the rotation does not count";
    } else if (zeros == 1) {
      const auto free = std::ranges::find(weights, 0.0) - weights.begin();
      EXPECT_NEAR(off.matrix()(free, free), 1, 1e-5) << "the axis points as commanded";
    } else if (zeros == 0) {
      EXPECT_NEAR(off.rotvec().norm(), 0, 3e-3);
    } else {
      EXPECT_LT(angle, 0.2);
    }
  }
}

TEST(CartesianPoseLimits, HoldsWithoutATargetAndAfterAReset) {
  Robot robot = RobotAlone(Rc7());
  CartesianPoseController& cartesian = Use(robot);
  const Pose start = robot.FkFrame();
  for (int i = 0; i < 300; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_TRUE(robot.FkFrame().is_close(start, 1e-4, 1e-4));
  cartesian.SetPose(Pose(Vector3d(0.3, 0.3, 0.3)));
  Scene scene = robot.scene();
  scene.Reset();
  EXPECT_TRUE(cartesian.pose().is_close(robot.FkFrame(), 1e-12, 1e-12));
}

TEST(CartesianPoseLimits, RejectsInvalidNumbers) {
  Robot robot = RobotAlone(Rc7());
  CartesianPoseController& cartesian = Use(robot);
  ExpectThrow<ArgumentError>([&] { cartesian.SetMaxSpeeds(0, 1); },
                             "group 'arm': the largest speeds cannot be 0 m/s and 1 rad/s");
  ExpectThrow<ArgumentError>([&] { cartesian.SetTarget(std::vector<double>(7, std::nan(""))); },
                             "group 'arm': value 0 of the pose is nan; all values must be finite");
  ExpectThrow<ArgumentError>([&] { cartesian.SetPosture(std::vector<double>(2)); },
                             "group 'arm': expected 7 joint values, got 2");
  ExpectThrow<ArgumentError>([&] { robot.SetController("gripper", "cartesian_pose"); },
                             "a gripper cannot have the controller 'cartesian_pose'");
}

}  // namespace
}  // namespace robocell
