// Tests the reach of chains against known lengths and against samples.
#include "robocell/kinematics/reach.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/testing/models.h"

namespace robocell {
namespace {

TEST(Reach, OfAPlanarArmIsTheSumOfItsLinks) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><body><joint/><geom "
      "size='.1'/>"
      "<body pos='.7 0 0'><joint range='0.5 2'/><geom size='.1'/><body name='tip' pos='.4 0 "
      "0'/></body></body></body>"
      "</worldbody></mujoco>");
  const double with_elbow_at_half_a_radian = std::sqrt(.49 + .16 + 2 * .7 * .4 * std::cos(0.5));
  EXPECT_NEAR(ApproximateReach(Chain(t.model(), "base", ChainTip::Body("tip"))),
              with_elbow_at_half_a_radian, 1e-6);
}

TEST(Reach, OfAnUnlimitedSlideIsTheLengthOfItsChain) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><worldbody><body name='base'><body><joint type='slide' axis='1 0 0'/><geom "
      "size='.1'/>"
      "<body name='tip' pos='2 0 0'/></body></body></worldbody></mujoco>");
  EXPECT_NEAR(ApproximateReach(Chain(t.model(), "base", ChainTip::Body("tip"))), 4, 1e-9);
}

TEST(Reach, IsWithinAPercentOfRandomPosesAndBelowTheBound) {
  for (int k = 0; k < 20; ++k) {
    Rng rng = Rng::Stream(1, "reach", k);
    TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 2 + k % 7}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const double reach = ApproximateReach(chain);
    EXPECT_EQ(ApproximateReach(chain), reach);
    EXPECT_LE(reach, chain.model().reach_bound + chain.model().joints[0].fixed.translation.norm());
    for (int i = 0; i < 3000; ++i) {
      t.Randomise(&rng);
      ASSERT_LE(t.TipInBase(chain).translation.norm(), reach * 1.01) << "chain " << k;
    }
  }
}

class MenagerieReach : public testing::TestWithParam<MenagerieArm> {};
INSTANTIATE_TEST_SUITE_P(Arms, MenagerieReach, testing::ValuesIn(MenagerieArms()), ArmName);

TEST_P(MenagerieReach, IsThatOfATableTopArm) {
  REQUIRE_MENAGERIE(GetParam().folder);
  TestModel t = TestModel::FromFile(MenagerieModel(GetParam().folder, GetParam().file));
  const Chain chain(t.model(), GetParam().base, GetParam().tip);
  Rng rng = Rng::Stream(2, "reach", GetParam().folder);
  const double reach = ApproximateReach(chain);
  for (int i = 0; i < 5000; ++i) {
    t.Randomise(&rng);
    ASSERT_LE(t.TipInBase(chain).translation.norm(), reach * 1.002);
  }
  EXPECT_GT(reach, 0.8);
  EXPECT_LT(reach, 1.5);
}

}  // namespace
}  // namespace robocell
