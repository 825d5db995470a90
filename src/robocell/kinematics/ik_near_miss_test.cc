// Tests poses that all restarts missed although one came near: those in corners of the limits are
// found, unreachable ones cost little more, and a caller that allows few starts gets no more.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

// Seven hinges between limits.
struct LimitedChain {
  explicit LimitedChain(int seed)
      : rng(Rng::Stream(seed, "near misses")),
        model(TestModel::FromXml(RandomChainXml(&rng, {.joints = 7,
                                                       .slide_share = 0,
                                                       .awkward = false,
                                                       .limited_share = 1,
                                                       .narrow = true})
                                     .Write())),
        chain(model.model(), "base", ChainTip::Site("tip")) {}

  // Puts some of the joints at one of their limits.
  Pose Reachable(double at_limits) {
    JointVector q = RandomJoints(chain, &rng);
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = chain.joints()[i];
      if (rng.Uniform() < at_limits) q[i] = rng.Uniform() < 0.5 ? joint.lower : joint.upper;
    }
    return chain.Fk(q);
  }
  // Returns poses anywhere in a ball around the root, with any rotation: most of them are
  // unreachable.
  Pose InTheReach() {
    Eigen::Vector3d place;
    do {
      for (double& x : place) x = rng.Uniform(-1, 1);
    } while (place.norm() > 1);
    const Transform& root = chain.model().joints[0].fixed;
    Eigen::Vector4d turn;
    for (double& x : turn) x = rng.Normal();
    return Pose(root.translation + chain.model().reach_bound * place,
                Eigen::Quaterniond(turn.normalized()).toRotationMatrix());
  }

  Rng rng;
  TestModel model;
  Chain chain;
};

TEST(IkNearMiss, SolvesTenThousandPosesOfLimitedChainsButOne) {
  constexpr int kTargets = 5000, kChains = 12;
  int solved = 0;
  for (int k = 0; k < kChains; ++k) {
    LimitedChain c(k);
    std::vector<Pose> targets;
    for (int b = 0; b < kTargets; ++b) targets.push_back(c.Reachable(0));
    const IkBatchResult found = IkBatch(c.chain, targets);
    solved += found.solved();
    for (int b = 0; b < kTargets; ++b) {
      if (!found.success[b]) continue;
      EXPECT_TRUE(EngineAgrees(c.model, c.chain, targets[b], found.row(b), 1.0001e-5));
    }
  }
  EXPECT_GE(solved, 0.9999 * kTargets * kChains);
}

TEST(IkNearMiss, SolvesPosesInCornersOfTheLimitsAloneAndTogether) {
  constexpr int kTargets = 200, kChains = 12;
  int together = 0, alone = 0;
  for (int k = 0; k < kChains; ++k) {
    LimitedChain c(k);
    std::vector<Pose> targets;
    for (int b = 0; b < kTargets; ++b) targets.push_back(c.Reachable(0.5));
    together += IkBatch(c.chain, targets).solved();
    for (const Pose& target : targets) alone += Ik(c.chain, target).success;
  }
  EXPECT_GE(together, 0.995 * kTargets * kChains);
  EXPECT_GE(alone, 0.995 * kTargets * kChains);
}

TEST(IkNearMiss, APreferenceDoesNotReduceSolvedCornerPoses) {
  constexpr int kTargets = 50, kChains = 12;
  int solved = 0;
  for (int k = 0; k < kChains; ++k) {
    LimitedChain c(k);
    std::vector<Pose> targets;
    for (int b = 0; b < kTargets; ++b) targets.push_back(c.Reachable(0.5));
    const IkOptions options{.prefer = IkPrefer::kAwayFromLimits};
    solved += IkBatch(c.chain, targets, {}, {.ik = options}).solved();
  }
  EXPECT_GE(solved, 0.995 * kTargets * kChains);
}

// Returns the mean number of steps of a query.
double StepsOf(const Chain& chain, const std::vector<Pose>& targets, int max_restarts) {
  const IkBatchResult found = IkBatch(chain, targets, {}, {.ik = {.max_restarts = max_restarts}});
  return std::accumulate(found.iterations.begin(), found.iterations.end(), 0.0) / found.size;
}

TEST(IkNearMiss, UnreachableTargetsTakeAtMostHalfAsLongAgain) {
  double before = 0, now = 0;
  for (int k = 0; k < 12; ++k) {
    LimitedChain c(k);
    std::vector<Pose> targets;
    for (int b = 0; b < 200; ++b) targets.push_back(c.InTheReach());
    before += StepsOf(c.chain, targets, 99);
    now += StepsOf(c.chain, targets, 100);
  }
  EXPECT_LT(now, 1.5 * before);
}

TEST(IkNearMiss, KeepsTheLimitOfRestarts) {
  LimitedChain c(3);
  for (int k = 0; k < 100; ++k)
    EXPECT_LE(Ik(c.chain, c.Reachable(0.5), {.max_restarts = 99}).restarts, 99);

  Rng rng = Rng::Stream(1, "five joints");
  const TestModel five = TestModel::FromXml(
      RandomChainXml(&rng, {.joints = 5, .slide_share = 0, .limited_share = 1}).Write());
  const Chain chain(five.model(), "base", ChainTip::Site("tip"));
  for (int k = 0; k < 20; ++k) {
    const Pose off(Eigen::Vector3d(0.03 * rng.Normal(), 0, 0), Eigen::Matrix3d::Identity().eval());
    const IkResult found = Ik(chain, chain.Fk(RandomJoints(chain, &rng)) * off);
    EXPECT_LE(found.restarts, 100);
  }
}

}  // namespace
}  // namespace robocell
