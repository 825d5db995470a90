// Frames, forward kinematics, Jacobians and gravity of whole robots against the engine, on mounts
// that are displaced, tilted and moved.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

// Joint values in the limits; hinges without limits anywhere in a turn.
std::vector<double> RandomJoints(const MoveGroup& group, Rng& rng) {
  std::vector<double> q;
  for (const Interval& limit : group.joint_pos_limits()) {
    const bool limited = std::isfinite(limit.lower);
    q.push_back(limited ? rng.Uniform(limit.lower, limit.upper) : rng.Uniform(-M_PI, M_PI));
  }
  return q;
}

double Difference(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

class AnyRobot : public ::testing::TestWithParam<RobotCase> {
 protected:
  Scene Build(const RobotSpec& placed) {
    RobotSpec spec = GetParam().spec();
    spec.name = GetParam().name;
    spec.prefix = "r_";
    spec.pos = placed.pos;
    spec.euler = placed.euler;
    return Scene::Build(SceneWith(spec));
  }
  Robot In(const Scene& scene) { return GetParam().robot(scene, GetParam().name); }
};
INSTANTIATE_TEST_SUITE_P(Robots, AnyRobot, ::testing::ValuesIn(AllRobots()), CaseName);

void ExpectFramesAgree(const Robot& robot, int pose) {
  const MoveGroup& arm = robot.arm();
  EXPECT_LT(Difference(robot.FkFrame(), arm.leaf_frame_to_robot()), 1e-12) << pose;
  EXPECT_LT(Difference(robot.tcp_in_world(), arm.leaf_frame_to_world()), 1e-15) << pose;
  EXPECT_LT(Difference(robot.base_in_world() * robot.FkFrame(), robot.tcp_in_world()), 1e-12);
  EXPECT_LT(Difference(arm.root_frame_to_world() * arm.leaf_frame_to_root(), robot.tcp_in_world()),
            1e-12);
}

TEST_P(AnyRobot, ChainAgreesWithItsGroupOnADisplacedAndTiltedMount) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build({.pos = {0.3, -0.2, 0.5}, .euler = {20, -35, 110}});
  Robot robot = In(scene);
  Rng rng = Rng::Stream(1, "robot fk", GetParam().name);
  for (int i = 0; i < 100; ++i) {
    robot.SetJointPos(RandomJoints(robot.arm(), rng));
    ExpectFramesAgree(robot, i);
  }
}

// The linear and angular velocity of the leaf by central differences of its pose.
Eigen::MatrixXd DifferenceJacobian(MoveGroup& group, const std::vector<double>& q) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd out(6, group.nv());
  for (int j = 0; j < group.nv(); ++j) {
    Pose ends[2];
    for (int side = 0; side < 2; ++side) {
      std::vector<double> moved = q;
      moved[j] += side == 0 ? -kStep : kStep;
      group.SetJointPos(moved);
      ends[side] = group.leaf_frame_to_world();
    }
    out.col(j) = PoseDifference(ends[0], ends[1]) / (2 * kStep);
  }
  group.SetJointPos(q);
  return out;
}

TEST_P(AnyRobot, JacobianAgreesWithTheEngineAndWithFiniteDifferences) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build({.pos = {0, 0, 1}, .euler = {180, 10, 0}});  // hangs from a ceiling
  Robot robot = In(scene);
  MoveGroup& arm = robot.arm();
  const mjModel* m = scene.model();
  Rng rng = Rng::Stream(2, "robot jacobian", GetParam().name);
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, arm.nv());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> p(3, m->nv), r(3, m->nv);
  for (int i = 0; i < 20; ++i) {
    const std::vector<double> q = RandomJoints(arm, rng);
    arm.SetJointPos(q);
    arm.Jacobian(jacobian);
    EXPECT_LT((jacobian - DifferenceJacobian(arm, q)).cwiseAbs().maxCoeff(), 2e-8);
    const Eigen::Vector3d tip = arm.leaf_frame_to_world().translation();
    const int last = m->jnt_bodyid[RequireId(m, mjOBJ_JOINT, arm.joint_names().back(), "")];
    mj_jac(m, scene.data(), p.data(), r.data(), tip.data(), last);
    for (int j = 0; j < arm.nv(); ++j) {
      const int dof = m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, arm.joint_names()[j], "")];
      EXPECT_LT((jacobian.col(j).head<3>() - p.col(dof)).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_LT((jacobian.col(j).tail<3>() - r.col(dof)).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST_P(AnyRobot, IkFindsThePoseOfARandomPosture) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build({.euler = {0, 0, 45}});
  Robot robot = In(scene);
  Rng rng = Rng::Stream(3, "robot ik", GetParam().name);
  for (int i = 0; i < 10; ++i) {
    const Pose target = robot.FkFrame(RandomJoints(robot.arm(), rng));
    const IkResult found = robot.Ik(target);
    ASSERT_TRUE(found.success);
    robot.SetJointPos(found.q);
    EXPECT_TRUE(robot.arm().leaf_frame_to_robot().is_close(target, 1e-5, 1e-5));
  }
}

// Built-in robot and arms with a tool included; answers judged by the engine.
TEST_P(AnyRobot, IkSolvesAThousandReachableTargets) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build({});
  Robot robot = In(scene);
  const std::vector<double> home = robot.arm().joint_pos();
  Rng rng = Rng::Stream(5, "reachable", GetParam().name);
  int solved = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose target = robot.FkFrame(RandomJoints(robot.arm(), rng));
    const IkResult found = robot.Ik(target, {.seed = JointVector(std::span<const double>(home))});
    if (!found.success) continue;
    ++solved;
    robot.arm().SetJointPos(found.q);
    EXPECT_TRUE(robot.arm().leaf_frame_to_robot().is_close(target, 1.001e-5, 1.001e-5));
    for (int j = 0; j < robot.n_joints(); ++j) {
      EXPECT_GE(found.q[j], robot.joint_limits()[j].lower);
      EXPECT_LE(found.q[j], robot.joint_limits()[j].upper);
    }
  }
  EXPECT_GE(solved, 990);
}

TEST_P(AnyRobot, LockedGroupsOutsideTheChainAreNoMatterAndThoseInsideStayPut) {
  REQUIRE_ROBOT(GetParam());
  const Scene scene = Build({});
  Robot robot = In(scene);
  const std::vector<std::string> all = robot.group_names();
  LockedJoints every{};
  for (int j = 0; j < robot.n_joints(); ++j) every[j] = true;
  EXPECT_EQ(robot.LockGroups(all), every);
  std::vector<std::string> others = all;
  std::erase(others, robot.arm().name());
  EXPECT_EQ(robot.LockGroups(others), LockedJoints{});
  EXPECT_THROW(robot.LockGroups(std::vector<std::string>{"amr"}), NotFoundError);
}

// What the engine says must act on the joints to keep everything still: the bias forces less the
// passive ones, at rest.
TEST_P(AnyRobot, GravityTorquesAreTheEnginesBiasForcesAtRest) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build({.euler = {30, 50, 0}});
  Robot robot = In(scene);
  const mjModel* m = scene.model();
  Rng rng = Rng::Stream(4, "robot gravity", GetParam().name);
  std::vector<double> torques(robot.n_joints());
  for (int i = 0; i < 20; ++i) {
    robot.SetJointPos(RandomJoints(robot.arm(), rng));
    robot.GravityTorques(torques);
    for (int j = 0; j < robot.n_joints(); ++j) {
      const int dof = m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, robot.joint_names()[j], "")];
      const double needed = scene.data()->qfrc_bias[dof] - scene.data()->qfrc_gravcomp[dof];
      EXPECT_NEAR(torques[j], needed, 1e-6) << robot.joint_names()[j];
    }
  }
}

TEST(RobotKinematics, AMocapBaseCarriesTheWholeRobotRigidly) {
  Robot robot = RobotAlone(Rc7());
  const Pose tcp_in_base = robot.FkFrame();
  const Pose mount = robot.base().pose().inverse() * robot.base_in_world();
  EXPECT_TRUE(mount.is_close(Pose(Eigen::Vector3d(0, 0, 0.25)), 1e-12, 1e-12)) << "the pedestal";
  const Pose placed = Pose::FromRpy({1, -2, 0.4}, {0.3, -0.5, 2});
  robot.base().SetPose(placed);
  EXPECT_TRUE(robot.base().pose().is_close(placed, 1e-12, 1e-12));
  EXPECT_TRUE(robot.base_in_world().is_close(placed * mount, 1e-12, 1e-12));
  EXPECT_TRUE(robot.tcp_in_world().is_close(placed * mount * tcp_in_base, 1e-12, 1e-12));
  ExpectFramesAgree(robot, 0);
}

TEST(RobotKinematics, GravityAlongZCanBeGivenAndIsRotatedIntoATiltedBase) {
  RobotConfig config = Rc7();
  config.gravcomp = false;
  const Scene scene =
      Scene::Build(SceneWith({.name = "rc7", .config = config, .euler = {0, 90, 0}}));
  Robot robot = Robot::Of(scene, "rc7");
  std::vector<double> full(7), half(7), none(7);
  robot.GravityTorques(full);
  robot.GravityTorques(half, -9.81 / 2);
  robot.GravityTorques(none, 0);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(half[i], full[i] / 2, 1e-9);
  EXPECT_EQ(none, std::vector<double>(7, 0.0));
  EXPECT_GT(std::abs(full[1]), 10) << "the arm lies flat";
}

TEST(RobotKinematics, GravcompTakesItsShareOfGravityTorques) {
  Robot compensated = RobotAlone(Rc7());
  std::vector<double> torques(7);
  compensated.GravityTorques(torques);
  EXPECT_EQ(torques, std::vector<double>(7, 0.0));
}

TEST(RobotKinematics, ReachIsMeasuredUnlessConfigured) {
  Robot measured = RobotAlone(Rc7());
  EXPECT_NEAR(measured.reach(), 0.28 + 0.82, 0.01) << "stretched upwards";
  RobotConfig config = Rc7();
  config.reach = 0.7;
  EXPECT_EQ(RobotAlone(config).reach(), 0.7);
}

}  // namespace
}  // namespace robocell
