// Our chains as KDL's: the two must agree on kinematics and dynamics.
#include "robocell/kinematics/kdl_bridge.h"

#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "robocell/kinematics/testing/models.h"

namespace robocell {
namespace {

void ExpectSameKinematics(const Chain& chain, const KDL::Chain& kdl, const JointVector& q) {
  KDL::Frame tip;
  KDL::ChainFkSolverPos_recursive(kdl).JntToCart(ToKdl(q), tip);
  EXPECT_LT(PoseDifference(FromKdl(tip), chain.Fk(q)).cwiseAbs().maxCoeff(), 1e-9);
  KDL::Jacobian theirs(chain.n_joints());
  Eigen::MatrixXd ours(6, chain.n_joints());
  KDL::ChainJntToJacSolver(kdl).JntToJac(ToKdl(q), theirs);
  chain.Jacobian(q, ours);
  EXPECT_LT((theirs.data - ours).cwiseAbs().maxCoeff(), 1e-9);
}

// Without gravity compensation, which KDL does not know.
void ExpectSameDynamics(const Chain& chain, const KDL::Chain& kdl, const JointVector& q) {
  const Eigen::Vector3d gravity(1, -3, -9);
  KDL::ChainDynParam dynamics(kdl, KDL::Vector(gravity[0], gravity[1], gravity[2]));
  KDL::JntArray their_torques(chain.n_joints());
  KDL::JntSpaceInertiaMatrix their_mass(chain.n_joints());
  JointVector torques(chain.n_joints());
  Eigen::MatrixXd mass(chain.n_joints(), chain.n_joints());
  dynamics.JntToGravity(ToKdl(q), their_torques);
  dynamics.JntToMass(ToKdl(q), their_mass);
  chain.GravityTorques(q, gravity, torques);
  chain.MassMatrix(q, mass);
  for (int i = 0; i < q.size(); ++i) EXPECT_NEAR(torques[i], their_torques(i), 1e-9);
  EXPECT_LT((their_mass.data - mass).cwiseAbs().maxCoeff(), 1e-9);
}

class KdlBridge : public testing::TestWithParam<MenagerieArm> {};
INSTANTIATE_TEST_SUITE_P(Robots, KdlBridge, testing::ValuesIn(MenagerieRobots()), ArmName);

TEST_P(KdlBridge, AgreesWithKdlOnRealRobots) {
  REQUIRE_MENAGERIE(GetParam().folder);
  TestModel t = TestModel::FromFile(MenagerieModel(GetParam().folder, GetParam().file));
  const Chain chain(t.model(), GetParam().base, GetParam().tip);
  const KDL::Chain kdl = ToKdl(chain);
  ASSERT_EQ(kdl.getNrOfJoints(), static_cast<unsigned>(chain.n_joints()));
  Rng rng = Rng::Stream(1, "kdl", GetParam().folder);
  for (int k = 0; k < 100; ++k) {
    t.Randomise(&rng);
    const JointVector q = t.ChainPositions(chain);
    ExpectSameKinematics(chain, kdl, q);
    ExpectSameDynamics(chain, kdl, q);
  }
}

TEST(KdlChain, AgreesWithKdlOnRandomChainsWithReferencesAndSlides) {
  for (int k = 0; k < 40; ++k) {
    Rng rng = Rng::Stream(2, "random kdl", k);
    TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 1 + k % 10}).Write());
    mju_zero(t.model()->body_gravcomp, t.model()->nbody);
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const KDL::Chain kdl = ToKdl(chain);
    t.Randomise(&rng);
    ExpectSameKinematics(chain, kdl, t.ChainPositions(chain));
    ExpectSameDynamics(chain, kdl, t.ChainPositions(chain));
  }
}

TEST(KdlChain, NamesSegmentsAsBodiesAndTheTip) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><worldbody><body name='base'><body name='gantry'><joint name='x' type='slide' "
      "axis='1 0 0'/>"
      "<joint name='y' type='slide' axis='0 1 0'/><geom size='.1'/><body name='arm'><joint "
      "name='turn'/>"
      "<geom size='.1'/><site name='tcp' pos='0 0 .1'/></body></body></body></worldbody></mujoco>");
  const KDL::Chain with_site = ToKdl(Chain(t.model(), "base", ChainTip::Site("tcp")));
  ASSERT_EQ(with_site.getNrOfSegments(), 4u);
  EXPECT_EQ(with_site.getSegment(0).getName(), "x");
  EXPECT_EQ(with_site.getSegment(1).getName(), "gantry");
  EXPECT_EQ(with_site.getSegment(2).getName(), "arm");
  EXPECT_EQ(with_site.getSegment(2).getJoint().getName(), "turn");
  EXPECT_EQ(with_site.getSegment(3).getName(), "tcp");
  EXPECT_EQ(ToKdl(Chain(t.model(), "base", ChainTip::Body("arm"))).getNrOfSegments(), 3u);
}

TEST(KdlChain, TakesPosesThereAndBack) {
  const Pose pose = Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3});
  EXPECT_LT(PoseDifference(FromKdl(ToKdl(pose)), pose).norm(), 1e-15);
  EXPECT_EQ(ToKdl(pose).p.y(), 2);
}

}  // namespace
}  // namespace robocell
