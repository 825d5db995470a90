// Tests that our chains and KDL's agree on kinematics and dynamics.
#include "robocell/kinematics/kdl_bridge.h"

#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/expect_throw.h"

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

// Compares the torques of a motion, and their part from the velocities.
void ExpectSameMotionTorques(const Chain& chain, const KDL::Chain& kdl, const JointVector& q,
                             const Eigen::Vector3d& gravity) {
  const int n = chain.n_joints();
  JointVector qd(n), qdd(n), coriolis(n), torques(n);
  for (int i = 0; i < n; ++i) qd[i] = std::sin(3 * i + 1), qdd[i] = std::cos(5 * i + 2);
  const KDL::Vector g(gravity[0], gravity[1], gravity[2]);
  KDL::JntArray theirs(n);
  KDL::ChainDynParam(kdl, g).JntToCoriolis(ToKdl(q), ToKdl(qd), theirs);
  chain.CoriolisTorques(q, qd, coriolis);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(coriolis[i], theirs(i), 1e-8);
  const KDL::Wrenches none(kdl.getNrOfSegments(), KDL::Wrench::Zero());
  KDL::ChainIdSolver_RNE(kdl, g).CartToJnt(ToKdl(q), ToKdl(qd), ToKdl(qdd), none, theirs);
  chain.InverseDynamics(q, qd, qdd, gravity, torques);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(torques[i], theirs(i), 1e-8);
}

// Without gravity compensation, which KDL does not support.
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
  ExpectSameMotionTorques(chain, kdl, q, gravity);
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

TEST(KdlChain, RoundTripsPoses) {
  const Pose pose = Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3});
  EXPECT_LT(PoseDifference(FromKdl(ToKdl(pose)), pose).norm(), 1e-15);
  EXPECT_EQ(ToKdl(pose).p.y(), 2);
}

TEST(KdlChain, FramesMapPointsLikeTheirPoses) {
  const Pose pose = Pose::FromRpy({0.4, -0.1, 0.3}, {0.2, 0.3, 0.5});
  const KDL::Frame frame = ToKdl(pose);
  const Eigen::Vector3d rim(0.01, 0.02, 0.1), in_world = pose * rim;
  const KDL::Vector same = frame * KDL::Vector(rim.x(), rim.y(), rim.z());
  EXPECT_LT((Eigen::Vector3d(same.x(), same.y(), same.z()) - in_world).norm(), 1e-12);
}

TEST(KdlChain, RoundTripsTwistsWrenchesAndJointValues) {
  const Wrench wrench{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(FromKdl(ToKdl(wrench)), wrench);
  EXPECT_EQ(ToKdl(wrench).torque.z(), 6);
  const Twist twist{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(FromKdl(ToKdl(twist)), twist);
  EXPECT_EQ(ToKdl(twist).rot.x(), 4);
  const JointVector q{0.1, -0.2};
  EXPECT_EQ(FromKdl(ToKdl(q)), q);
}

TEST(KdlChain, RoundTrips) {
  for (int k = 0; k < 40; ++k) {
    Rng rng = Rng::Stream(3, "kdl and back", k);
    TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 1 + k % 10}).Write());
    mju_zero(t.model()->body_gravcomp, t.model()->nbody);
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const KDL::Chain kdl = ToKdl(chain);
    const Chain back = FromKdl(kdl);
    EXPECT_EQ(back.joint_names(), chain.joint_names());
    EXPECT_NEAR(back.moving_mass(), chain.moving_mass(), 1e-12);
    t.Randomise(&rng);
    const JointVector q = t.ChainPositions(chain);
    EXPECT_LT(PoseDifference(back.Fk(q), chain.Fk(q)).norm(), 1e-12);
    ExpectSameKinematics(back, kdl, q);
    ExpectSameDynamics(back, kdl, q);
  }
}

KDL::RigidBodyInertia SomeInertia(double mass) {
  return KDL::RigidBodyInertia(mass, KDL::Vector(0.01, -0.02, 0.05),
                               KDL::RotationalInertia(0.02, 0.03, 0.04, 0.001, 0.002, 0.003));
}

// Every kind of joint in KDL, off its origin, with offsets, an armature and fixed segments at the
// ends and in between.
KDL::Chain HandMadeChain() {
  const KDL::Frame step(KDL::Rotation::RPY(0.1, -0.4, 0.7), KDL::Vector(0.1, 0.2, 0.3));
  KDL::Chain chain;
  chain.addSegment(KDL::Segment("foot", KDL::Joint(KDL::Joint::Fixed), step, SomeInertia(9)));
  chain.addSegment(KDL::Segment("a", KDL::Joint("turn_x", KDL::Joint::RotX), step, SomeInertia(2)));
  chain.addSegment(KDL::Segment("b", KDL::Joint("lift", KDL::Joint::TransZ, 1, 0.2), step));
  chain.addSegment(KDL::Segment("plate", KDL::Joint(KDL::Joint::Fixed), step, SomeInertia(1)));
  chain.addSegment(
      KDL::Segment("c",
                   KDL::Joint("askew", KDL::Vector(0.1, 0, -0.2), KDL::Vector(1, 2, -1),
                              KDL::Joint::RotAxis, 1, -0.6, 0.25),
                   step, SomeInertia(0.5)));
  chain.addSegment(KDL::Segment(
      "d", KDL::Joint("slide", KDL::Vector(0, 0.1, 0), KDL::Vector(0, 1, 1), KDL::Joint::TransAxis),
      step, SomeInertia(0.3)));
  chain.addSegment(KDL::Segment("tool", KDL::Joint(KDL::Joint::Fixed), step, SomeInertia(0.2)));
  return chain;
}

TEST(KdlChain, MatchesACustomKdlChain) {
  const KDL::Chain kdl = HandMadeChain();
  const std::vector<std::array<double, 2>> limits = {{-1, 1}, {0, 0.5}, {-2, 2}, {-0.1, 0.1}};
  const Chain chain = FromKdl(kdl, limits);
  EXPECT_EQ(chain.joint_names(), (std::vector<std::string>{"turn_x", "lift", "askew", "slide"}));
  EXPECT_EQ(chain.joints()[1].type, ChainJointType::kSlide);
  EXPECT_EQ(chain.joints()[3].upper, 0.1);
  EXPECT_EQ(chain.description(), "chain 'base' -> body 'tool'");
  EXPECT_NEAR(chain.moving_mass(), 4.0, 1e-12) << "the foot stands still";
  Rng rng = Rng::Stream(4, "hand-made kdl", 0);
  for (int k = 0; k < 20; ++k) {
    JointVector q(4);
    for (double& v : q) v = rng.Uniform(-2, 2);
    ExpectSameKinematics(chain, kdl, q);
    ExpectSameDynamics(chain, kdl, q);
  }
}

TEST(KdlChain, ExplainsUnsupportedChains) {
  KDL::Chain geared;
  geared.addSegment(KDL::Segment("a", KDL::Joint("j", KDL::Joint::RotZ, 2)));
  ExpectThrow<ArgumentError>([&] { FromKdl(geared); },
                             "KDL chain: joint 'j' has scale 2; a chain's joints have scale 1");
  KDL::Chain stiff;
  stiff.addSegment(KDL::Segment("a", KDL::Joint(KDL::Joint::Fixed)));
  ExpectThrow<ArgumentError>([&] { FromKdl(stiff); }, "KDL chain: it has no joint that moves");
  const std::vector<std::array<double, 2>> one = {{0, 1}}, swapped(4, {1, -1});
  ExpectThrow<ArgumentError>([&] { FromKdl(HandMadeChain(), one); },
                             "KDL chain: 1 limit for 4 moving joints");
  ExpectThrow<ArgumentError>([&] { FromKdl(HandMadeChain(), swapped); },
                             "the limits of joint 'turn_x' are 1 and -1; give the lower one first");
  const std::vector<std::array<double, 2>> nowhere(4, {INFINITY, INFINITY});
  ExpectThrow<ArgumentError>(
      [&] { FromKdl(HandMadeChain(), nowhere); },
      "the limits of joint 'turn_x' are both inf; a joint without limits has -inf and inf");
  KDL::Chain twins;
  twins.addSegment(KDL::Segment("a", KDL::Joint("j", KDL::Joint::RotZ)));
  twins.addSegment(KDL::Segment("b", KDL::Joint("j", KDL::Joint::RotX)));
  ExpectThrow<ArgumentError>(
      [&] { FromKdl(twins); },
      "KDL chain: two of its joints are named 'j'; give each a different name");
}

}  // namespace
}  // namespace robocell
