// Tests forward kinematics and Jacobians against the engine's, on real robots and on random chains.
#include <gtest/gtest.h>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/testing/engine_says.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

constexpr double kFkTolerance = 1e-12, kJacobianTolerance = 1e-9;

double Distance(const Transform& a, const Transform& b) {
  return std::max((a.translation - b.translation).cwiseAbs().maxCoeff(),
                  (a.rotation - b.rotation).cwiseAbs().maxCoeff());
}

void ExpectAgreement(const TestModel& t, const Chain& chain) {
  const JointVector q = t.ChainPositions(chain);
  Eigen::MatrixXd jacobian(6, chain.n_joints());
  const Pose tip = chain.Jacobian(q, jacobian);
  EXPECT_LT(Distance(ToTransform(chain.Fk(q)), t.TipInBase(chain)), kFkTolerance);
  EXPECT_EQ(tip, chain.Fk(q));
  EXPECT_LT((jacobian - EngineJacobian(t, chain)).cwiseAbs().maxCoeff(), kJacobianTolerance);

  std::vector<Pose> bodies(chain.n_joints());
  EXPECT_EQ(chain.FkAll(q, bodies), tip);
  const Transform world_in_base = t.BodyInWorld(chain.base_body()).inverse();
  for (int i = 0; i < chain.n_joints(); ++i) {
    const std::string& body = chain.joints()[i].body;
    if (i + 1 < chain.n_joints() && chain.joints()[i + 1].body == body) continue;
    EXPECT_LT(Distance(ToTransform(bodies[i]), world_in_base * t.BodyInWorld(body)), kFkTolerance)
        << body;
  }
}

class MenagerieChain : public testing::TestWithParam<MenagerieArm> {};
INSTANTIATE_TEST_SUITE_P(Robots, MenagerieChain, testing::ValuesIn(MenagerieRobots()), ArmName);

TEST_P(MenagerieChain, AgreesWithTheEngineOnAnyMount) {
  REQUIRE_MENAGERIE(GetParam().folder);
  TestModel t = TestModel::FromFile(MenagerieModel(GetParam().folder, GetParam().file));
  const Chain chain(t.model(), GetParam().base, GetParam().tip);
  Rng rng = Rng::Stream(1, "chain fk", GetParam().folder);
  for (int k = 0; k < 1000; ++k) {
    if (k % 100 == 50) t.Displace(GetParam().base, &rng);
    t.Randomise(&rng);
    ExpectAgreement(t, chain);
    if (HasFailure()) FAIL() << "at pose " << k;
  }
}

TEST(RandomChain, AgreesWithTheEngineOnEveryInstructionSet) {
  OnEveryInstructionSet([](const std::string&) {
    for (int joints = 1; joints <= 16; ++joints) {
      Rng rng = Rng::Stream(3, "random chain fk", joints);
      TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = joints}).Write());
      const Chain chain(t.model(), "base", ChainTip::Site("tip"));
      for (int i = 0; i < 5; ++i) {
        t.Randomise(&rng);
        ExpectAgreement(t, chain);
      }
      ASSERT_FALSE(::testing::Test::HasFailure()) << joints << " joints";
    }
  });
}

TEST(RandomChain, AcceptsAnglesOfManyTurns) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(4, "many turns");
    TestModel t = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 7, .slide_share = 0, .limited_share = 0}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    for (const double turns : {1e3, 1e4, 1e6}) {
      JointVector q(7), wound(7);
      for (int i = 0; i < 7; ++i) {
        q[i] = rng.Uniform(-3, 3);
        wound[i] = q[i] + (i % 2 ? 2 : -2) * M_PI * turns;
      }
      const Pose off = chain.Fk(q).inverse() * chain.Fk(wound);
      EXPECT_LT(off.translation().norm() + off.angle(), 1e-14 * turns);
    }
  });
}

TEST(RandomChain, AgreesWithTheEngineWithSlidesAnchorsReferencesAndMovingBases) {
  for (int k = 0; k < 200; ++k) {
    Rng rng = Rng::Stream(2, "random chain fk", k);
    const int joints = 1 + static_cast<int>(rng.UniformInt(12));
    const std::string xml = RandomChainXml(&rng, {.joints = joints}).Write();
    TestModel t = TestModel::FromXml(xml);
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    ASSERT_EQ(chain.n_joints(), joints);
    for (int i = 0; i < 20; ++i) {
      t.Randomise(&rng);
      ExpectAgreement(t, chain);
    }
    ASSERT_FALSE(HasFailure()) << xml;
  }
}

TEST(RandomChain, CanStartAtTheWorldAndContainTheMountJoints) {
  Rng rng = Rng::Stream(3, "from world");
  TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 4}).Write());
  const Chain chain(t.model(), "world", ChainTip::Site("tip"));
  ASSERT_EQ(chain.n_joints(), 6);
  EXPECT_EQ(chain.joints()[0].name, "mount_x");
  EXPECT_EQ(chain.joints()[1].body, "mount");
  t.Randomise(&rng);
  ExpectAgreement(t, chain);
}

TEST(RandomChain, HasTheJacobianOfFiniteDifferences) {
  Rng rng = Rng::Stream(4, "differences");
  TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 9}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  t.Randomise(&rng);
  const JointVector q = t.ChainPositions(chain);
  Eigen::MatrixXd jacobian(6, 9);
  chain.Jacobian(q, jacobian);
  for (int i = 0; i < 9; ++i) {
    JointVector before = q, after = q;
    before[i] -= 1e-5;
    after[i] += 1e-5;
    const Eigen::VectorXd twist = PoseDifference(chain.Fk(before), chain.Fk(after)) / 2e-5;
    EXPECT_LT((twist - jacobian.col(i)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

}  // namespace
}  // namespace robocell
