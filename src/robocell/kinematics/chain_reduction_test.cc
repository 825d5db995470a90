// Tests chains in which joints follow others against the engine with all joints at Expand(q).
#include "robocell/kinematics/chain_reduction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/coupled_chains.h"
#include "robocell/kinematics/testing/engine_says.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::ElementsAre;

// Puts all joints of the chain where the degrees of freedom say.
void PutCoupled(const TestModel& t, const Chain& chain, const JointVector& x) {
  const JointVector q = chain.Expand(x);
  for (int i = 0; i < q.size(); ++i) t.data()->qpos[chain.link_joints()[i].qpos_address] = q[i];
}

// The change of all degrees of freedom of the model with those of the chain.
MatrixXd CoupledSlopes(const TestModel& t, const Chain& chain, const JointVector& x) {
  MatrixXd d = MatrixXd::Zero(t.model()->nv, chain.n_joints());
  for (int l = 0; l < chain.n_joints(); ++l) d(chain.joints()[l].dof_address, l) = 1;
  for (const ChainFollower& f : chain.followers()) {
    if (f.leader >= 0) d(f.joint.dof_address, f.leader) = f.of_leader.slope(x[f.leader]);
  }
  return d;
}

class CoupledChain : public testing::TestWithParam<int> {
 protected:
  CoupledChain()
      : rng(Rng::Stream(7, "coupled chains", GetParam())),
        xml(CoupledChainXml(&rng, 2 + static_cast<int>(rng.UniformInt(9)))),
        t(TestModel::FromXml(xml)) {
    t.Randomise(&rng);
    chain.emplace(ChainAsItStands(t, "base", ChainTip::Site("tip")));
    x = RandomJoints(*chain, &rng);
    PutCoupled(t, *chain, x);
    mj_forward(t.model(), t.data());
    slopes = CoupledSlopes(t, *chain, x);
  }

  Rng rng;
  std::string xml;
  TestModel t;
  std::optional<Chain> chain;
  JointVector x;
  MatrixXd slopes;
};
INSTANTIATE_TEST_SUITE_P(Random, CoupledChain, testing::Range(0, 60));

TEST_P(CoupledChain, KeepsTheConstraintsOfTheEngine) {
  EXPECT_EQ(chain->n_joints() + static_cast<int>(chain->followers().size()),
            static_cast<int>(chain->link_joints().size()));
  ASSERT_FALSE(chain->followers().empty());
  int row = 0;
  MatrixXd full = MatrixXd::Zero(1, t.model()->nv);
  for (; row < t.data()->nefc && t.data()->efc_type[row] == mjCNSTR_EQUALITY; ++row)
    EXPECT_NEAR(t.data()->efc_pos[row], 0, 1e-12) << xml;
  EXPECT_EQ(row, t.model()->neq);
  for (const ChainFollower& f : chain->followers()) {
    EXPECT_GE(f.of_leader.at(x[f.leader]), f.joint.lower - 1e-9) << f.joint.name;
    EXPECT_LE(f.of_leader.at(x[f.leader]), f.joint.upper + 1e-9) << f.joint.name;
  }
}

TEST_P(CoupledChain, MovesTheTipLikeTheEngine) {
  const Transform tip = ToTransform(chain->Fk(x)), engine = t.TipInBase(*chain);
  EXPECT_LT((tip.translation - engine.translation).norm(), 1e-12) << xml;
  EXPECT_LT((tip.rotation - engine.rotation).norm(), 1e-12);
  std::vector<Pose> bodies(static_cast<std::size_t>(chain->n_joints()));
  chain->FkAll(x, bodies);
  for (int l = 0; l < chain->n_joints(); ++l) {
    const ChainJoint& joint = chain->joints()[l];
    if (t.model()->body_jntnum[t.model()->jnt_bodyid[joint.id]] > 1) continue;
    const Transform body = t.BodyInWorld("base").inverse() * t.BodyInWorld(joint.body);
    EXPECT_LT((body.translation - bodies[l].translation()).norm(), 1e-12) << joint.name;
  }
}

TEST_P(CoupledChain, HasTheJacobianOfTheEngine) {
  MatrixXd p(t.model()->nv, 3), r(t.model()->nv, 3);  // transposed: the engine's are row by row
  const Transform tip = t.TipInWorld(chain->tip());
  const int site = mj_name2id(t.model(), mjOBJ_SITE, "tip");
  mj_jac(t.model(), t.data(), p.data(), r.data(), tip.translation.data(),
         t.model()->site_bodyid[site]);
  const Eigen::Matrix3d to_base = t.BodyInWorld("base").rotation.transpose();
  MatrixXd expected(6, chain->n_joints());
  expected << to_base * p.transpose() * slopes, to_base * r.transpose() * slopes;
  Eigen::Matrix<double, 6, Eigen::Dynamic> j(6, chain->n_joints());
  chain->Jacobian(x, j);
  EXPECT_LT((j - expected).cwiseAbs().maxCoeff(), 1e-10) << xml;
}

TEST_P(CoupledChain, HasTheDynamicsOfTheEngine) {
  const int n = chain->n_joints(), nv = t.model()->nv;
  MatrixXd full(nv, nv), mass(n, n);
  mj_fullM(t.model(), t.data(), full.data());
  chain->MassMatrix(x, mass);
  EXPECT_LT((mass - slopes.transpose() * full * slopes).cwiseAbs().maxCoeff(), 1e-9) << xml;

  const Eigen::Vector3d gravity = GravityInBase(t, *chain);
  JointVector qd(n), qdd(n), torques(n);
  for (int i = 0; i < n; ++i) qd[i] = rng.Normal(), qdd[i] = rng.Normal();
  mju_zero(t.data()->qvel, nv);
  mju_zero(t.data()->qacc, nv);
  Eigen::Map<VectorXd>(t.data()->qvel, nv) = slopes * Eigen::Map<const VectorXd>(qd.data(), n);
  Eigen::Map<VectorXd> acceleration(t.data()->qacc, nv);
  acceleration = slopes * Eigen::Map<const VectorXd>(qdd.data(), n);
  for (const ChainFollower& f : chain->followers())
    acceleration[f.joint.dof_address] +=
        f.of_leader.curvature(x[f.leader]) * qd[f.leader] * qd[f.leader];
  mj_fwdPosition(t.model(), t.data());
  mj_fwdVelocity(t.model(), t.data());
  VectorXd bias(nv), inertial(nv);
  mj_rne(t.model(), t.data(), 0, bias.data());
  mj_mulM(t.model(), t.data(), inertial.data(), t.data()->qacc);
  bias += inertial - Eigen::Map<const VectorXd>(t.data()->qfrc_gravcomp, nv);
  chain->InverseDynamics(x, qd, qdd, gravity, torques);
  const VectorXd expected = slopes.transpose() * bias;
  EXPECT_LT((Eigen::Map<const VectorXd>(torques.data(), n) - expected).cwiseAbs().maxCoeff(), 1e-9)
      << xml;

  mju_zero(t.data()->qvel, nv);
  mj_forward(t.model(), t.data());
  const VectorXd still =
      slopes.transpose() * (Eigen::Map<const VectorXd>(t.data()->qfrc_bias, nv) -
                            Eigen::Map<const VectorXd>(t.data()->qfrc_gravcomp, nv));
  chain->GravityTorques(x, gravity, torques);
  EXPECT_LT((Eigen::Map<const VectorXd>(torques.data(), n) - still).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(CoupledChain, ComputesBatchesLikeSinglePoses) {
  const auto n = static_cast<std::size_t>(chain->n_joints());
  constexpr std::size_t kCount = 37;
  const std::vector<double> gravity = {1, -2, -9};
  std::vector<double> q, qd, qdd;
  for (std::size_t k = 0; k < kCount; ++k) {
    for (const double value : RandomJoints(*chain, &rng)) {
      q.push_back(value);
      qd.push_back(rng.Normal());
      qdd.push_back(rng.Normal());
    }
  }
  std::vector<double> tips(16 * kCount), jacobians(6 * n * kCount), weight(n * kCount),
      masses(n * n * kCount), torques(n * kCount), values(kCount), more_tips(16 * kCount);
  FkBatch(*chain, q, tips);
  JacobianBatch(*chain, q, jacobians, more_tips);
  GravityTorquesBatch(*chain, q, gravity, weight);
  MassMatrixBatch(*chain, q, masses);
  InverseDynamicsBatch(*chain, q, qd, qdd, gravity, torques);
  ManipulabilityBatch(*chain, q, values);
  const Eigen::Vector3d g(1, -2, -9);
  for (std::size_t k = 0; k < kCount; ++k) {
    const JointVector at(std::span<const double>(&q[k * n], n)),
        v(std::span<const double>(&qd[k * n], n)), a(std::span<const double>(&qdd[k * n], n));
    JointVector torque(chain->n_joints());
    Eigen::Matrix<double, 6, Eigen::Dynamic> j(6, n);
    MatrixXd mass(n, n);
    const Transform tip = ToTransform(chain->Jacobian(at, j));
    chain->MassMatrix(at, mass);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(tips[16 * k + 4 * r + 3], tip.translation[r], 1e-12);
      EXPECT_NEAR(more_tips[16 * k + 4 * r + 3], tip.translation[r], 1e-12);
    }
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c < n; ++c)
        EXPECT_NEAR(jacobians[(6 * k + r) * n + c], j(static_cast<int>(r), static_cast<int>(c)),
                    1e-11);
    }
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t c = 0; c < n; ++c)
        EXPECT_NEAR(masses[(n * k + r) * n + c], mass(static_cast<int>(r), static_cast<int>(c)),
                    1e-10);
    }
    chain->GravityTorques(at, g, torque);
    for (std::size_t r = 0; r < n; ++r)
      EXPECT_NEAR(weight[n * k + r], torque[static_cast<int>(r)], 1e-10);
    chain->InverseDynamics(at, v, a, g, torque);
    for (std::size_t r = 0; r < n; ++r)
      EXPECT_NEAR(torques[n * k + r], torque[static_cast<int>(r)], 1e-9);
    EXPECT_NEAR(values[k], Manipulability(*chain, at), 1e-12);
  }
}

TEST_P(CoupledChain, ClimbsInManipulability) {
  std::array<double, kMaxChainJoints> gradient;
  if (Manipulability(*chain, x) < 1e-6) GTEST_SKIP() << "singular";
  LogManipulabilityGradient(chain->model(), x.data(), gradient.data());
  for (int l = 0; l < chain->n_joints(); ++l) {
    JointVector up = x, down = x;
    const double h = 1e-5;
    up[l] += h, down[l] -= h;
    const double slope =
        (std::log(Manipulability(*chain, up)) - std::log(Manipulability(*chain, down))) / (2 * h);
    EXPECT_NEAR(gradient[l], slope, 1e-3 * (1 + std::abs(slope))) << l;
  }
}

TEST_P(CoupledChain, SolvesInverseKinematicsWithinTheLimitsOfAll) {
  constexpr int kCount = 60;
  std::vector<Pose> targets;
  for (int k = 0; k < kCount; ++k) targets.push_back(chain->Fk(RandomJoints(*chain, &rng)));
  const IkBatchResult batch = IkBatch(*chain, targets, {}, {});
  int good = 0, singles = 0;
  const auto judge = [&](const Pose& target, const JointVector& q) {
    EXPECT_TRUE(InLimits(*chain, q));
    PutCoupled(t, *chain, q);
    mj_kinematics(t.model(), t.data());
    const Transform tip = t.TipInBase(*chain);
    EXPECT_LT((tip.translation - target.translation()).norm(), 1.001e-5);
    for (const ChainFollower& f : chain->followers()) {
      EXPECT_GE(f.of_leader.at(q[f.leader]), f.joint.lower - 1e-9);
      EXPECT_LE(f.of_leader.at(q[f.leader]), f.joint.upper + 1e-9);
    }
  };
  for (int b = 0; b < batch.size; ++b) {
    if (batch.success[b]) judge(targets[static_cast<std::size_t>(b)], JointVector(batch.row(b)));
    good += batch.success[b];
  }
  for (const Pose& target : targets) {
    const IkResult one = Ik(*chain, target, {.prefer = IkPrefer::kFirst});
    if (one.success) judge(target, one.q);
    singles += one.success;
  }
  RecordProperty("solved", good);
  EXPECT_GE(good, kCount - 1) << xml;
  EXPECT_GE(singles, kCount - 1) << xml;
}

// A telescope whose three stages follow one another, and a parallelogram behind it.
constexpr const char* kTelescope = R"(<mujoco><compiler angle="radian"/>
  <default><geom contype="0" conaffinity="0"/></default><worldbody><body name="base">
  <geom size=".1"/><body name="s1"><joint name="s1" type="slide" axis="1 0 0" range="0 .13"/><geom size=".05"/>
  <body name="s2" pos=".1 0 0"><joint name="s2" type="slide" axis="1 0 0" range="0 .12"/><geom size=".05"/>
  <body name="s3" pos=".1 0 0"><joint name="s3" type="slide" axis="1 0 0" range="-.01 .1"/><geom size=".05"/>
  <body name="p" pos=".1 0 0"><joint name="p" axis="0 1 0" range="-2 1"/><geom size=".05"/>
  <body name="l" pos=".3 0 0"><joint name="l" axis="0 1 0" range="-.9 1.5"/><geom size=".05"/>
  <site name="tip" pos=".1 0 0"/></body></body></body></body></body></body></worldbody>
  <equality><joint joint1="s2" joint2="s1"/><joint joint1="s3" joint2="s2" polycoef="-.02 1 0 0 0"/>
  <joint joint1="l" joint2="p" polycoef="0 -1 0 0 0"/></equality></mujoco>)";

TEST(ReducedChain, HasTheLimitsThatAllFollowersKeep) {
  const TestModel t = TestModel::FromXml(kTelescope);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  EXPECT_THAT(chain.joint_names(), ElementsAre("s1", "p"));
  ASSERT_EQ(chain.followers().size(), 3U);
  EXPECT_EQ(chain.followers()[2].joint.name, "l");
  EXPECT_EQ(chain.followers()[2].leader, 1);
  EXPECT_DOUBLE_EQ(chain.joints()[0].lower, 0.01);  // s3 = s1 - 0.02
  EXPECT_DOUBLE_EQ(chain.joints()[0].upper, 0.12);
  EXPECT_DOUBLE_EQ(chain.joints()[1].lower, -1.5);  // l = -p
  EXPECT_DOUBLE_EQ(chain.joints()[1].upper, 0.9);
  EXPECT_EQ(chain.Expand(JointVector{0.1, 0.5}), (JointVector{0.1, 0.1, 0.08, 0.5, -0.5}));
  // The parallelogram keeps the tip's orientation.
  EXPECT_NEAR(chain.Fk(JointVector{0.1, 0.5}).rotation()(0, 0), 1, 1e-12);
}

TEST(ReducedChain, MovesItsFollowersInASimulationWithTheConstraints) {
  const TestModel t = TestModel::FromXml(kTelescope);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  mju_zero3(t.model()->opt.gravity);
  PutCoupled(t, chain, {0.05, 0.2});
  t.data()->qvel[chain.joints()[1].dof_address] = 0.5;
  t.data()->qvel[chain.followers()[2].joint.dof_address] = -0.5;
  for (int k = 0; k < 100; ++k) mj_step(t.model(), t.data());
  mj_kinematics(t.model(), t.data());
  const Transform tip = t.TipInBase(chain), ours = ToTransform(chain.Fk(t.ChainPositions(chain)));
  EXPECT_LT((tip.translation - ours.translation).norm(), 1e-3);  // constraints are soft
}

TEST(ReducedChain, IsLedByItsFirstJointIfTheLeaderIsOutside) {
  std::string xml = kTelescope;
  xml.insert(
      xml.find("<site name=\"tip\""),
      "<body><joint name='out' type='slide' axis='1 0 0' range='-1 1'/><geom size='.01'/></body>");
  xml.replace(xml.find("<joint joint1=\"s2\" joint2=\"s1\"/>"), 32,
              "<joint joint1='s1' joint2='out' polycoef='0 2 0 0 0'/>"
              "<joint joint1='s2' joint2='out' polycoef='.01 1 0 0 0'/>");
  const TestModel t = TestModel::FromXml(xml);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  EXPECT_THAT(chain.joint_names(), ElementsAre("s1", "p"));
  EXPECT_DOUBLE_EQ(chain.Expand(JointVector{0.1, 0})[1], 0.06);
}

// One joint that is coupled to a side branch moves the chain alone, as an arm's finger does.
TEST(ReducedChain, IsTheWholeChainIfNoJointFollowsAnotherOfIt) {
  const TestModel t = TestModel::FromXml(
      R"(<mujoco><worldbody><body name="base"><body name="a"><joint name="a"/><geom size=".1"/><site name="tip"/></body>
      <body><joint name="b"/><geom size=".1"/></body></body></worldbody>
      <equality><joint joint1="a" joint2="b" polycoef="0 1 .5 0 0"/></equality></mujoco>)");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  EXPECT_EQ(chain.coupled(), nullptr);
  EXPECT_THAT(chain.joint_names(), ElementsAre("a"));
}

TEST(ReducedChain, RejectsCouplingsThatCannotBeReduced) {
  const struct {
    const char* equalities;
    const char* why;
  } cases[] = {
      {"<joint joint1='s2' joint2='s1'/><joint joint1='s1' joint2='s2'/>",
       "joints 's2', 's1' follow each other in a circle"},
      {"<joint joint1='s2' joint2='s1'/><joint joint1='s2' joint2='p'/>",
       "joint 's2' follows both 's1' and 'p'"},
      {"<joint joint1='l' joint2='p' polycoef='0 0 1 0 0'/>",
       "joint 'l' follows 'p' by a polynomial that turns back within the limits of 'p', -2 to 1"},
      {"<joint joint1='s2' joint2='p' polycoef='3 .1 0 0 0'/>",
       "joint 's2' follows 'p' outside of its own limits, 0 to 0.12"}};
  for (const auto& [equalities, why] : cases) {
    std::string xml = kTelescope;
    const std::size_t at = xml.find("<equality>") + 10;
    xml.replace(at, xml.find("</equality>") - at, equalities);
    const TestModel t = TestModel::FromXml(xml);
    ExpectThrow<ArgumentError>([&] { Chain(t.model(), "base", ChainTip::Site("tip")); }, why);
  }
}

TEST(ReducedChain, IncludesRotorsBehindTendonsOfItsFollowers) {
  std::string xml = kTelescope;
  xml.insert(xml.find("<equality>"),
             "<tendon><fixed name='t' armature='3'><joint joint='s1' coef='1'/><joint joint='s3' "
             "coef='2'/><joint joint='p' coef='-.5'/></fixed></tendon>");
  const TestModel t = TestModel::FromXml(xml);
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const JointVector x{0.05, 0.3};
  PutCoupled(t, chain, x);
  mj_forward(t.model(), t.data());
  const MatrixXd d = CoupledSlopes(t, chain, x);
  MatrixXd full(t.model()->nv, t.model()->nv), mass(2, 2);
  mj_fullM(t.model(), t.data(), full.data());
  chain.MassMatrix(x, mass);
  EXPECT_LT((mass - d.transpose() * full * d).cwiseAbs().maxCoeff(), 1e-12);
  JointVector torques(2);
  const JointVector still(2), qdd{0.7, -2};
  chain.InverseDynamics(x, still, qdd, Eigen::Vector3d::Zero(), torques);
  EXPECT_NEAR(torques[0], mass(0, 0) * qdd[0] + mass(0, 1) * qdd[1], 1e-12);
  std::vector<double> masses(4);
  MassMatrixBatch(chain, x, masses);
  EXPECT_NEAR(masses[1], mass(0, 1), 1e-12);
  EXPECT_NEAR(masses[3], mass(1, 1), 1e-12);
}

}  // namespace
}  // namespace robocell
