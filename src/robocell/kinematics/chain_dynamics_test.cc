// Tests gravity torques, mass matrix and inverse dynamics against the engine's.
#include <gtest/gtest.h>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/testing/engine_says.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

using internal::ComputeLinks;
using internal::LinkAnswer;
using internal::LinkPart;
using internal::TipOf;

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

double LargestDifference(const JointVector& a, const VectorXd& b) {
  return (Eigen::Map<const VectorXd>(a.data(), a.size()) - b).cwiseAbs().maxCoeff();
}

void ExpectGravityOfTheEngine(const TestModel& t, const Chain& chain) {
  JointVector torques(chain.n_joints());
  chain.GravityTorques(t.ChainPositions(chain), GravityInBase(t, chain), torques);
  EXPECT_LT(LargestDifference(torques, EngineGravityTorques(t, chain)), 1e-10);
}

void ExpectMassMatrixOfTheEngine(const TestModel& t, const Chain& chain) {
  MatrixXd mass(chain.n_joints(), chain.n_joints());
  chain.MassMatrix(t.ChainPositions(chain), mass);
  EXPECT_LT((mass - EngineMassMatrix(t, chain)).cwiseAbs().maxCoeff(), 1e-10);
}

void ExpectInverseDynamicsOfTheEngine(const TestModel& t, const Chain& chain, Rng* rng) {
  JointVector qd(chain.n_joints()), qdd(chain.n_joints()), torques(chain.n_joints());
  for (int i = 0; i < qd.size(); ++i) qd[i] = rng->Normal(), qdd[i] = rng->Normal();
  chain.InverseDynamics(t.ChainPositions(chain), qd, qdd, GravityInBase(t, chain), torques);
  EXPECT_LT(LargestDifference(torques, EngineInverseDynamics(t, chain, qd, qdd)), 1e-9);
}

class MenagerieDynamics : public testing::TestWithParam<MenagerieArm> {};
INSTANTIATE_TEST_SUITE_P(Arms, MenagerieDynamics, testing::ValuesIn(MenagerieArms()), ArmName);

TEST_P(MenagerieDynamics, AgreesWithTheEngineOnTiltedMountsWithTheGripperWhereItIs) {
  REQUIRE_MENAGERIE(GetParam().folder);
  TestModel t = TestModel::FromFile(MenagerieModel(GetParam().folder, GetParam().file));
  Rng rng = Rng::Stream(1, "chain dynamics", GetParam().folder);
  for (int k = 0; k < 40; ++k) {
    if (k == 20) t.Displace(GetParam().base, &rng);
    t.Randomise(&rng);
    const Chain chain = ChainAsItStands(t, GetParam().base, GetParam().tip);
    ExpectGravityOfTheEngine(t, chain);
    ExpectMassMatrixOfTheEngine(t, chain);
    ExpectInverseDynamicsOfTheEngine(t, chain, &rng);
    if (HasFailure()) FAIL() << "at pose " << k;
  }
}

TEST(RandomChainDynamics, AgreesWithTheEngineWithSideBranchesAndGravityCompensation) {
  for (int k = 0; k < 100; ++k) {
    Rng rng = Rng::Stream(2, "random dynamics", k);
    const std::string xml =
        RandomChainXml(&rng, {.joints = 1 + static_cast<int>(rng.UniformInt(10))}).Write();
    TestModel t = TestModel::FromXml(xml);
    t.Randomise(&rng);
    const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
    ExpectGravityOfTheEngine(t, chain);
    ExpectMassMatrixOfTheEngine(t, chain);
    ExpectInverseDynamicsOfTheEngine(t, chain, &rng);
    ASSERT_FALSE(HasFailure()) << xml;
  }
}

TEST(ChainDynamics, IncludesRotorInertiaBehindGears) {
  TestModel t =
      TestModel::FromXml(R"(<mujoco><compiler angle="radian"/><worldbody><body name="base">
      <geom size=".1"/><body><joint name="a" axis="0 1 0" armature=".1"/><geom size=".1" pos=".3 0 0"/>
      <body pos=".5 0 0"><joint name="b" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/>
      <site name="tip" pos=".4 0 0"/></body></body></body></worldbody>
      <actuator><motor joint="b" armature="3e-5" gear="100"/><position joint="a" kp="9" armature=".02"/>
      <motor joint="a" armature=".01" gear="3"/></actuator></mujoco>)");
  Rng rng = Rng::Stream(4, "rotors");
  for (int k = 0; k < 10; ++k) {
    t.Randomise(&rng);
    const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
    EXPECT_NEAR(chain.model().joints[1].armature, 0.3, 1e-12);
    ExpectMassMatrixOfTheEngine(t, chain);
    ExpectInverseDynamicsOfTheEngine(t, chain, &rng);
  }
}

// Side branches do not move, so that a tendon to one of them is a rotor of the joint in the chain.
constexpr const char* kTendons =
    R"(<mujoco><compiler angle="radian"/><worldbody><body name="base">
      <geom size=".1"/><body><joint name="a" axis="0 1 0" armature=".1"/><geom size=".1" pos=".3 0 0"/>
      <body pos=".5 0 0"><joint name="b" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/>
      <body pos=".1 0 0"><joint name="side" axis="1 0 0"/><geom size=".1"/></body>
      <body pos=".2 0 0"><joint name="c" type="slide" axis="1 0 0"/><geom size=".1" pos=".2 0 0"/>
      <site name="tip" pos=".4 0 0"/></body></body></body></body></worldbody>
      <tendon><fixed name="all" armature="3"><joint joint="a" coef="1"/><joint joint="b" coef="-2"/>
      <joint joint="c" coef=".5"/></fixed>
      <fixed name="pulled"><joint joint="b" coef="1.5"/><joint joint="c" coef="1"/></fixed>
      <fixed name="beside" armature=".7"><joint joint="side" coef="1"/><joint joint="a" coef="2"/>
      </fixed></tendon>
      <actuator><motor tendon="pulled" armature=".2" gear="3"/></actuator></mujoco>)";

TEST(ChainDynamics, RotorsBehindFixedTendonsCoupleTheJoints) {
  TestModel t = TestModel::FromXml(kTendons);
  Rng rng = Rng::Stream(5, "tendons");
  for (int k = 0; k < 10; ++k) {
    t.Randomise(&rng);
    const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
    ASSERT_EQ(chain.couplings().size(), 4u);
    ExpectGravityOfTheEngine(t, chain);
    ExpectMassMatrixOfTheEngine(t, chain);
    ExpectInverseDynamicsOfTheEngine(t, chain, &rng);
  }
}

TEST(ChainDynamics, BatchesIncludeRotorsBehindFixedTendons) {
  const TestModel t = TestModel::FromXml(kTendons);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  constexpr int kRows = 5, n = 3;
  Rng rng = Rng::Stream(6, "tendons");
  std::vector<double> q(kRows * n), qd(kRows * n), qdd(kRows * n), torques(kRows * n),
      masses(kRows * n * n);
  for (auto* values : {&q, &qd, &qdd}) {
    for (double& value : *values) value = rng.Normal();
  }
  const Vector3d gravity(1, 2, -9);
  const std::span<const double> g(gravity.data(), 3);
  MassMatrixBatch(chain, q, masses);
  for (const bool one : {false, true}) {  // acceleration for all rows
    const std::span<const double> change = std::span(qdd).first(one ? n : kRows * n);
    InverseDynamicsBatch(chain, q, qd, change, g, torques);
    for (int row = 0; row < kRows; ++row) {
      const auto of = [&](std::span<const double> values) {
        return values.subspan(values.size() > n ? row * n : 0, n);
      };
      VectorXd single(n);
      chain.InverseDynamics(of(q), of(qd), of(change), gravity, {single.data(), n});
      for (int i = 0; i < n; ++i) EXPECT_NEAR(of(torques)[i], single[i], 1e-10) << row;
      MatrixXd mass(n, n);
      chain.MassMatrix(of(q), mass);
      EXPECT_LT((Eigen::Map<const MatrixXd>(&masses[row * n * n], n, n) - mass).norm(), 1e-10);
    }
  }
}

// Covers all numbers of lanes, full and not.
TEST(RandomChainDynamics, AgreesWithTheEngineOnEveryInstructionSet) {
  OnEveryInstructionSet([](const std::string&) {
    for (int joints = 1; joints <= 16; ++joints) {
      Rng rng = Rng::Stream(3, "random dynamics", joints);
      TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = joints}).Write());
      t.Randomise(&rng);
      const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
      ExpectGravityOfTheEngine(t, chain);
      ExpectMassMatrixOfTheEngine(t, chain);
      ExpectInverseDynamicsOfTheEngine(t, chain, &rng);
      ASSERT_FALSE(::testing::Test::HasFailure()) << joints << " joints";
    }
  });
}

// One pass computes the same as the separate parts, to the bit.
TEST(RandomChainDynamics, IsTheSameInOneCallAndInParts) {
  OnEveryInstructionSet([](const std::string&) {
    for (const int joints : {1, 6, 7, 16}) {
      Rng rng = Rng::Stream(4, "random dynamics", joints);
      TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = joints}).Write());
      t.Randomise(&rng);
      const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
      const JointVector q(t.ChainPositions(chain));
      JointVector qd(joints), torques(joints);
      for (double& v : qd) v = rng.Normal();
      const Vector3d gravity = GravityInBase(t, chain);
      LinkAnswer all;
      ComputeLinks(chain.links(), LinkPart::kAll,
                   {.q = q.data(), .qd = qd.data(), .gravity = gravity.data()}, &all);
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joints);
      MatrixXd mass(joints, joints);
      EXPECT_TRUE(TipOf(all).pose() == chain.Jacobian(q, jacobian));
      chain.MassMatrix(q, mass);
      chain.InverseDynamics(q, qd, JointVector(joints), gravity, torques);
      for (int i = 0; i < joints; ++i) {
        EXPECT_EQ(all.torques[i], torques[i]) << joints;
        for (int r = 0; r < 6; ++r) EXPECT_EQ(all.jacobian[r][i], jacobian(r, i)) << joints;
        for (int k = 0; k <= i; ++k) EXPECT_EQ(all.mass[i][k], mass(i, k)) << joints;
      }
    }
  });
}

// A base far from the arm costs no digits.
TEST(ChainDynamics, IsTheSameFarFromTheBase) {
  MatrixXd masses[2] = {MatrixXd(2, 2), MatrixXd(2, 2)};
  for (const int far : {0, 1}) {
    const TestModel t = TestModel::FromXml(fmt::format(
        "<mujoco><worldbody><body name='arm' pos='{} 0 0'><joint axis='0 1 0'/>"
        "<geom size='.1' pos='.5 0 0'/><body name='hand' pos='1 0 0'><joint axis='0 1 0'/>"
        "<geom size='.1' pos='.3 0 0'/></body></body></worldbody></mujoco>",
        far * 1000));
    Chain(t.model(), "world", ChainTip::Body("hand"))
        .MassMatrix(JointVector{0.3, 0.8}, masses[far]);
  }
  EXPECT_EQ(masses[0], masses[1]);
}

TEST(ChainDynamics, NeedsNoTorqueWhereEveryBodyIsCompensated) {
  TestModel t = TestModel::FromXml(
      "<mujoco><worldbody><body name='arm' gravcomp='1'><joint name='j' axis='0 1 0'/>"
      "<geom size='.1' pos='.5 0 0'/><body gravcomp='1'><geom size='.1' pos='1 0 "
      "0'/></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "world", ChainTip::Body("arm"));
  double torque = 1;
  chain.GravityTorques(JointVector{0.3}, {0, 0, -9.81}, {&torque, 1});
  EXPECT_EQ(torque, 0);
  EXPECT_GT(chain.moving_mass(), 1);
}

TEST(ChainDynamics, FreezesSideBranchesAtTheReferenceByDefault) {
  TestModel t = TestModel::FromXml(
      "<mujoco><worldbody><body name='arm'><joint name='j' axis='0 1 0'/><geom size='.1' mass='1'/>"
      "<body name='finger'><joint name='f' type='slide' axis='1 0 0'/><geom size='.1' "
      "mass='2'/></body></body>"
      "</worldbody></mujoco>");
  const std::array<double, 2> open = {0, 0.5};
  double at_reference = 0, as_it_stands = 0;
  const Vector3d gravity(0, 0, -10);
  Chain(t.model(), "world", ChainTip::Body("arm"))
      .GravityTorques(JointVector{0}, gravity, {&at_reference, 1});
  Chain(t.model(), "world", ChainTip::Body("arm"), {.qpos = open})
      .GravityTorques(JointVector{0}, gravity, {&as_it_stands, 1});
  EXPECT_NEAR(at_reference, 0, 1e-12);
  EXPECT_NEAR(as_it_stands, -2 * 10 * 0.5, 1e-12);
}

}  // namespace
}  // namespace robocell
