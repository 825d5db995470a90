// Tests frames, forward kinematics, Jacobians and gravity of whole robots against the engine, on
// displaced, tilted and moved mounts.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

// Returns joint values within the limits; hinges without limits anywhere in a turn.
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

// Returns the linear and angular velocity of the leaf by central differences of its pose.
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

// Includes the built-in robot and arms with a tool; the engine judges the solutions.
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

TEST_P(AnyRobot, LockedGroupsMatterOnlyInsideTheChain) {
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

// The engine's torques that keep everything still: the bias forces less the passive ones, at rest.
TEST_P(AnyRobot, GravityTorquesMatchTheEngineAtRest) {
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

// The dynamics of impedance control with the present tool, which the chain contains as one body.
TEST_P(AnyRobot, InverseDynamicsAndMassMatchTheEngine) {
  REQUIRE_ROBOT(GetParam());
  Scene scene = Build({.pos = {0, 0, 1}, .euler = {30, 50, 0}});
  Robot robot = In(scene);
  const mjModel* m = scene.model();
  const auto& arm = dynamic_cast<const ArmGroup&>(robot.arm());
  const int n = arm.nv();
  Rng rng = Rng::Stream(6, "robot bias", GetParam().name);
  std::vector<int> dofs;
  for (const ChainJoint& joint : arm.chain().joints()) dofs.push_back(joint.dof_address);
  std::vector<double> needed(n), still(n);
  Eigen::MatrixXd mass(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all(m->nv, m->nv);
  for (int i = 0; i < 20; ++i) {
    robot.SetJointPos(RandomJoints(robot.arm(), rng));
    const std::vector<double> q = arm.joint_pos();
    std::vector<double> qd(n);
    for (double& v : qd) v = rng.Uniform(-2, 2);
    robot.arm().SetJointVel(qd);
    scene.Forward();
    robot.RefreshToolInertia();
    arm.InverseDynamics(q, qd, still, needed);
    arm.chain().MassMatrix(q, mass);
    const mjData* d = scene.data();
    mj_fullM(m, d, all.data());
    for (int r = 0; r < n; ++r) {
      EXPECT_NEAR(needed[r], d->qfrc_bias[dofs[r]] - d->qfrc_gravcomp[dofs[r]], 1e-6)
          << robot.joint_names()[r];
      for (int c = 0; c < n; ++c) EXPECT_NEAR(mass(r, c), all(dofs[r], dofs[c]), 1e-6);
    }
  }
}

TEST(RobotKinematics, AMocapBaseMovesTheWholeRobotRigidly) {
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

TEST(RobotKinematics, GravityAlongZIsRotatedIntoATiltedBase) {
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

TEST(RobotKinematics, GravcompReducesGravityTorques) {
  Robot compensated = RobotAlone(Rc7());
  std::vector<double> torques(7);
  compensated.GravityTorques(torques);
  EXPECT_EQ(torques, std::vector<double>(7, 0.0));
}

// The Gen3 with the 2F-85 as two separate bodies, hanging from the ceiling, without compensation.
Scene HangingGen3() {
  return Scene::Build(SceneWith({.path = "menagerie:kinova_gen3/gen3.xml",
                                 .pos = {0, 0, 2},
                                 .euler = {180, 0, 30},
                                 .attachments = {{.mjcf_path = "menagerie:robotiq_2f85/2f85.xml",
                                                  .attach_to = Site("pinch_site"),
                                                  .prefix = "g_"}}}));
}

Robot Gen3In(const Scene& scene) {
  return Robot::FromScene(scene, "base_link", "bracelet_link",
                          {.tool = {.tool_body = "g_base", .tcp_site = "g_pinch"}});
}

TEST(RobotKinematics, TheToolsSiteIsTheTcp) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  const Scene scene = HangingGen3();
  const Robot robot = Gen3In(scene);
  EXPECT_TRUE(robot.has_tcp_frame());
  EXPECT_EQ(robot.tcp_site(), "g_pinch");
  const Pose in_base = scene.body_pose("base_link").inverse() * scene.site_pose("g_pinch");
  EXPECT_LT(Difference(robot.FkFrame(), in_base), 1e-12);
  const Pose in_tip = scene.body_pose("bracelet_link").inverse() * scene.site_pose("g_pinch");
  EXPECT_LT(Difference(robot.tip_to_tcp(), in_tip), 1e-12);

  const Robot bare = Robot::FromScene(scene, "base_link", "bracelet_link");
  EXPECT_FALSE(bare.has_tcp_frame());
  EXPECT_EQ(bare.tcp_site(), "");
  EXPECT_LT(Difference(bare.tip_to_tcp(), Pose()), 1e-12);
  const Robot configured = RobotAlone(Rc7());
  EXPECT_EQ(configured.tcp_site(), "tcp");
  EXPECT_NEAR(configured.tip_to_tcp().translation().z(), 0.152, 1e-12) << "from link7";
}

TEST(RobotKinematics, IncludesTheMassOfTheTool) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  const Scene scene = HangingGen3();
  const mjModel* m = scene.model();
  const double arm = m->body_subtreemass[RequireId(m, mjOBJ_BODY, "shoulder_link", "")];
  EXPECT_NEAR(Gen3In(scene).chain().moving_mass(), arm, 1e-12);
  EXPECT_GT(m->body_subtreemass[RequireId(m, mjOBJ_BODY, "g_base_mount", "")], 0.8);
}

// Returns the largest difference between the gravity torques and those that the engine needs at
// rest.
double GravityError(Robot& robot) {
  Scene scene = robot.scene();
  mju_zero(scene.data()->qvel, scene.model()->nv);
  scene.Forward();
  std::vector<double> torques(robot.n_joints());
  robot.GravityTorques(torques);
  double error = 0;
  for (int j = 0; j < robot.n_joints(); ++j) {
    const int dof = robot.chain().joints()[j].dof_address;
    error = std::max(error, std::abs(torques[j] - scene.data()->qfrc_bias[dof]));
  }
  return error;
}

TEST(RobotKinematics, RefreshingToolInertiaIncludesAClosedGripper) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  Scene scene = HangingGen3();
  Robot robot = Gen3In(scene);
  robot.SetJointPos(std::vector<double>{0.3, 0.8, -0.5, 1.2, 0.2, 1.1, 0.4});
  EXPECT_LT(GravityError(robot), 1e-9) << "open, as at the reference";
  scene.SetActuatorCtrl("g_fingers_actuator", 255);
  EXPECT_TRUE(scene.StepN(500).ok());
  const double stale = GravityError(robot);
  EXPECT_GT(stale, 1e-4) << "the linkage has moved";
  EXPECT_LT(stale, 5e-2);
  robot.RefreshToolInertia();
  EXPECT_LT(GravityError(robot), 1e-9);
  scene.Reset();
  EXPECT_LT(GravityError(robot), 1e-9) << "a reset forgets it";
}

TEST(RobotKinematics, GravityIsInBaseAxes) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  const Robot robot = Gen3In(HangingGen3());
  EXPECT_LT((robot.gravity_in_base() - Eigen::Vector3d(0, 0, 9.81)).norm(), 1e-12);
  EXPECT_LT((robot.gravity_in_base(-1) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
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
