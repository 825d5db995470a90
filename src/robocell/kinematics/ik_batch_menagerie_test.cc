// Tests batched inverse kinematics on real arms and on random chains, judged by the engine: success
// rates, limits, tolerances, unreachable targets.
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

std::vector<Pose> ReachableTargets(const Chain& chain, int count, Rng* rng) {
  std::vector<Pose> targets;
  for (int b = 0; b < count; ++b) targets.push_back(chain.Fk(RandomJoints(chain, rng)));
  return targets;
}

// Returns the number of solved targets; every claimed solution must convince the engine.
int CountSolvedTogether(const TestModel& t, const Chain& chain, const std::vector<Pose>& targets,
                        double tolerance = 1e-5) {
  const IkBatchResult result = IkBatch(chain, targets, {}, {.ik = {.tolerance = tolerance}});
  int convinced = 0;
  for (int b = 0; b < result.size; ++b) {
    EXPECT_TRUE(InLimits(chain, result.row(b)));
    if (result.success[b])
      convinced += EngineAgrees(t, chain, targets[b], result.row(b), 1.0001 * tolerance);
  }
  EXPECT_EQ(convinced, result.solved());
  return result.solved();
}

class MenagerieIkBatch : public testing::TestWithParam<MenagerieArm> {
 protected:
  void SetUp() override { REQUIRE_MENAGERIE(GetParam().folder); }
};
INSTANTIATE_TEST_SUITE_P(Arms, MenagerieIkBatch, testing::ValuesIn(MenagerieArms()), ArmName);

TEST_P(MenagerieIkBatch, SolvesTwentyThousandReachableTargetsWithinTheLimits) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(1, "batched ik targets", GetParam().folder);
  const std::vector<Pose> targets = ReachableTargets(arm.chain, 20000, &rng);
  EXPECT_GE(CountSolvedTogether(arm.model, arm.chain, targets), 19998);
}

TEST_P(MenagerieIkBatch, SolvesToTightTolerances) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(2, "batched ik targets", GetParam().folder);
  const std::vector<Pose> targets = ReachableTargets(arm.chain, 2000, &rng);
  EXPECT_GE(CountSolvedTogether(arm.model, arm.chain, targets, 1e-8), 1999);
}

// A seed near a solution leads to that solution: joints do not jump.
TEST_P(MenagerieIkBatch, StaysNearANearbySeed) {
  const Arm arm(GetParam());
  Rng rng = Rng::Stream(3, "batched ik targets", GetParam().folder);
  std::vector<Pose> targets;
  std::vector<double> seeds;
  for (int b = 0; b < 500; ++b) {
    const JointVector start = RandomJoints(arm.chain, &rng);
    JointVector goal = start;
    for (int i = 0; i < goal.size(); ++i) {
      const JointModel& joint = arm.chain.model().joints[i];
      seeds.push_back(start[i]);
      goal[i] = std::clamp(start[i] + rng.Uniform(-0.01, 0.01), joint.lower, joint.upper);
    }
    targets.push_back(arm.chain.Fk(goal));
  }
  const IkBatchResult result = IkBatch(arm.chain, targets, seeds);
  EXPECT_EQ(result.solved(), 500);
  for (std::size_t k = 0; k < seeds.size(); ++k) EXPECT_NEAR(result.q[k], seeds[k], 0.3);
}

TEST(IkBatchOfRandomChains, SolvesFiveToTwelveJointsWithSlidesAndWithoutLimits) {
  for (int k = 0; k < 24; ++k) {
    Rng rng = Rng::Stream(4, "random batched ik", k);
    const TestModel t = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 5 + k % 8, .slide_share = 0.1 * (k % 3)}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const std::vector<Pose> targets = ReachableTargets(chain, 1000, &rng);
    EXPECT_GE(CountSolvedTogether(t, chain, targets), 998) << "chain " << k;
  }
}

// A step must not expect motion from joints that hardly move.
TEST(IkBatchOfRandomChains, SolvesEightToTwelveJointsOfWhichSomeAreNearlyFixed) {
  int solved = 0, total = 0;
  for (int k = 0; k < 30; ++k) {
    Rng rng = Rng::Stream(9, "nearly fixed", k);
    const TestModel t = TestModel::FromXml(
        RandomChainXml(&rng,
                       {.joints = 8 + k % 5, .slide_share = 0.1 * (k % 3), .tiny_share = 0.35})
            .Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const std::vector<Pose> targets = ReachableTargets(chain, 1000, &rng);
    solved += CountSolvedTogether(t, chain, targets);
    total += 1000;
  }
  EXPECT_GE(solved, total - 20);
}

// Each choice of two locked values is a chain that is in no table.
TEST(IkBatchOfRandomChains, KeepsLockedJointsExactly) {
  Rng rng = Rng::Stream(5, "locked batch");
  const TestModel t = TestModel::FromXml(
      RandomChainXml(&rng, {.joints = 9, .slide_share = 0, .limited_share = 1}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  std::vector<Pose> targets;
  std::vector<double> seeds;
  for (int b = 0; b < 300; ++b) {
    JointVector truth(9);
    for (int i = 0; i < 9; ++i)
      truth[i] = rng.Uniform(chain.joints()[i].lower, chain.joints()[i].upper);
    targets.push_back(chain.Fk(truth));
    for (int i = 0; i < 9; ++i) seeds.push_back(i == 1 || i == 6 ? truth[i] : 0);
  }
  IkBatchOptions options;
  options.ik.locked[1] = options.ik.locked[6] = true;
  const IkBatchResult result = IkBatch(chain, targets, seeds, options);
  EXPECT_GE(result.solved(), 298);
  for (int b = 0; b < result.size; ++b) {
    EXPECT_EQ(result.row(b)[1], seeds[9 * b + 1]);
    EXPECT_EQ(result.row(b)[6], seeds[9 * b + 6]);
  }
}

TEST(IkBatchOfRandomChains, ReportsResidualsOfUnreachableTargets) {
  Rng rng = Rng::Stream(6, "out of reach");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 7}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  for (const double far : {20.0, 1e6, 1e200, 1e308}) {
    const std::vector<Pose> targets = {Pose(Eigen::Vector3d(far, far, -far))};
    const IkBatchResult result = IkBatch(chain, targets);
    EXPECT_EQ(result.solved(), 0);
    EXPECT_NEAR(result.position_error[0] / (far * std::sqrt(3.0)), 1, 0.3);
    for (const double q : result.q) EXPECT_TRUE(std::isfinite(q));
    const JointVector best(result.row(0));
    EXPECT_NEAR((chain.Fk(best).translation() - targets[0].translation()).stableNorm() / far,
                result.position_error[0] / far, 1e-12);
  }
}

// These numbers overflow in every kernel: the result is within the limits and depends on its own
// query alone.
TEST(IkBatchOfRandomChains, SolvesAbsurdTargetsInABatchAsIndividually) {
  Rng rng = Rng::Stream(8, "absurd");
  const TestModel t = TestModel::FromXml(
      RandomChainXml(&rng, {.joints = 5, .slide_share = 0, .limited_share = 1}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  for (const double far : {1e30, 1e160, 1.79e308}) {
    std::vector<Pose> targets = ReachableTargets(chain, 40, &rng);
    targets.emplace_back(Eigen::Vector3d(far, far, 0));
    const IkBatchResult all = IkBatch(chain, targets);
    const IkBatchResult alone = IkBatch(chain, std::span(targets).last(1));
    EXPECT_TRUE(std::ranges::equal(all.row(40), alone.row(0))) << far;
    EXPECT_TRUE(InLimits(chain, alone.row(0))) << far;
  }
}

TEST(IkBatchOfRandomChains, ReachesPositionsWithFreeRotation) {
  Rng rng = Rng::Stream(7, "positions");
  const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 4}).Write());
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const std::vector<Pose> targets = ReachableTargets(chain, 500, &rng);
  const IkBatchResult result = IkBatch(chain, targets, {}, {.ik = {.position_only = true}});
  EXPECT_GE(result.solved(), 499);
  for (int b = 0; b < result.size; ++b) {
    if (!result.success[b]) continue;
    EXPECT_LE((chain.Fk(result.row(b)).translation() - targets[b].translation()).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace robocell
