// Gravity torques, mass matrix and inverse dynamics against the engine's.
#include <gtest/gtest.h>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// The rows of a vector over all degrees of freedom that belong to the chain.
VectorXd Rows(const Chain& chain, const mjtNum* all) {
  VectorXd out(chain.n_joints());
  for (int i = 0; i < out.size(); ++i) out[i] = all[chain.joints()[i].dof_address];
  return out;
}

double LargestDifference(const JointVector& a, const VectorXd& b) {
  return (Eigen::Map<const VectorXd>(a.data(), a.size()) - b).cwiseAbs().maxCoeff();
}

Vector3d GravityInBase(const TestModel& t, const Chain& chain) {
  const Vector3d gravity = Eigen::Map<const Vector3d>(t.model()->opt.gravity);
  return t.BodyInWorld(chain.base_body()).rotation.transpose() * gravity;
}

Chain ChainAsItStands(const TestModel& t, const std::string& base, const ChainTip& tip) {
  const std::span<const double> qpos(t.data()->qpos, t.model()->nq);
  return Chain(t.model(), base, tip, {.qpos = qpos});
}

void ExpectGravityOfTheEngine(const TestModel& t, const Chain& chain) {
  mju_zero(t.data()->qvel, t.model()->nv);
  mj_forward(t.model(), t.data());
  const VectorXd expected = Rows(chain, t.data()->qfrc_bias) - Rows(chain, t.data()->qfrc_gravcomp);
  JointVector torques(chain.n_joints());
  chain.GravityTorques(t.ChainPositions(chain), GravityInBase(t, chain), torques);
  EXPECT_LT(LargestDifference(torques, expected), 1e-10);
}

void ExpectMassMatrixOfTheEngine(const TestModel& t, const Chain& chain) {
  const int n = chain.n_joints(), nv = t.model()->nv;
  MatrixXd full(nv, nv), mass(n, n);
  mj_fullM(t.model(), t.data(), full.data());
  chain.MassMatrix(t.ChainPositions(chain), mass);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      EXPECT_NEAR(mass(i, j), full(chain.joints()[i].dof_address, chain.joints()[j].dof_address),
                  1e-10);
    }
  }
}

// Moves only the chain, as the engine would, and asks both for the torques.
void ExpectInverseDynamicsOfTheEngine(const TestModel& t, const Chain& chain, Rng* rng) {
  const int n = chain.n_joints();
  JointVector qd(n), qdd(n);
  mju_zero(t.data()->qvel, t.model()->nv);
  mju_zero(t.data()->qacc, t.model()->nv);
  for (int i = 0; i < n; ++i) {
    t.data()->qvel[chain.joints()[i].dof_address] = qd[i] = rng->Normal();
    t.data()->qacc[chain.joints()[i].dof_address] = qdd[i] = rng->Normal();
  }
  mj_fwdPosition(t.model(), t.data());
  mj_fwdVelocity(t.model(), t.data());
  VectorXd bias_and_inertia(t.model()->nv);
  JointVector torques(n);
  mj_rne(t.model(), t.data(), 1, bias_and_inertia.data());
  VectorXd expected = Rows(chain, bias_and_inertia.data()) - Rows(chain, t.data()->qfrc_gravcomp);
  for (int i = 0; i < n; ++i) {
    expected[i] += t.model()->dof_armature[chain.joints()[i].dof_address] * qdd[i];
  }
  chain.InverseDynamics(t.ChainPositions(chain), qd, qdd, GravityInBase(t, chain), torques);
  EXPECT_LT(LargestDifference(torques, expected), 1e-9);
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

TEST(ChainDynamics, FreezesSideBranchesAtTheReferenceUnlessToldWhereTheyAre) {
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
