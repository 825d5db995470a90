// Tests that results are alike at every size of a chain, from a watchmaker's to a crane's: a metre
// of a slide counts relative to the length of the chain.
#include <gtest/gtest.h>

#include <algorithm>

#include "robocell/kinematics/differential_ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

constexpr int kQueriesOfASize = 300;

// The same random chain with slides, and the same queries, at a size.
struct Sized {
  Sized(int seed, int joints, double size)
      : size(size),
        rng(Rng::Stream(seed, "sizes of chains")),
        model(TestModel::FromXml(
            RandomChainXml(&rng,
                           {.joints = joints, .slide_share = 0.4, .awkward = false, .size = size})
                .Write())),
        chain(model.model(), "base", ChainTip::Site("tip")) {}

  double unit(int i) const { return chain.model().joints[i].slide ? size : 1; }
  // Returns values in the limits that are nearer to `from` than a part of a radian or of the size.
  JointVector Near(const JointVector& from, double part) {
    JointVector q = from;
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = chain.joints()[i];
      q[i] = std::clamp(q[i] + part * unit(i) * rng.Uniform(-1, 1), joint.lower, joint.upper);
    }
    return q;
  }
  // Chains up to one metre scale their accuracy with their size; longer ones are as accurate as
  // floating point allows.
  double tolerance() const { return 1e-5 * std::min(1.0, size); }

  double size;
  Rng rng;
  TestModel model;
  Chain chain;
};

struct Solved {
  int cold = 0, near = 0, one_by_one = 0, one_by_one_near = 0;
};

Solved SolvedAt(int seed, double size) {
  Sized s(seed, 6 + seed % 3, size);
  std::vector<Pose> targets;
  std::vector<double> seeds;
  for (int k = 0; k < kQueriesOfASize; ++k) {
    const JointVector q = RandomJoints(s.chain, &s.rng), near = s.Near(q, 1e-3);
    targets.push_back(s.chain.Fk(q));
    seeds.insert(seeds.end(), near.begin(), near.end());
  }
  const IkOptions options{.tolerance = s.tolerance()};
  Solved solved;
  const IkBatchResult cold = IkBatch(s.chain, targets, {}, {.ik = options});
  const IkBatchResult near = IkBatch(s.chain, targets, seeds, {.ik = options});
  solved.cold = cold.solved();
  solved.near = near.solved();
  const std::size_t n = s.chain.n_joints();
  for (int k = 0; k < kQueriesOfASize; ++k) {
    IkOptions one = options;
    solved.one_by_one += Ik(s.chain, targets[k], one).success;
    one.seed = JointVector(std::span(seeds).subspan(k * n, n));
    one.max_restarts = 0;
    solved.one_by_one_near += Ik(s.chain, targets[k], one).success;
    if (cold.success[k]) {
      const double rounding = 1e-14 * std::max(1.0, size);
      EXPECT_TRUE(EngineAgrees(s.model, s.chain, targets[k], cold.row(k),
                               1.0001 * options.tolerance + rounding));
    }
  }
  return solved;
}

TEST(SizeOfChain, SlidesSolveEquallyAtEverySize) {
  for (int seed = 0; seed < 6; ++seed) {
    const Solved metres = SolvedAt(seed, 1);
    for (const double size : {1e-3, 1e2, 1e4}) {
      const Solved solved = SolvedAt(seed, size);
      const auto where = fmt::format("chain {}, size {}", seed, size);
      EXPECT_GE(solved.cold, metres.cold - 3) << where;
      EXPECT_GE(solved.one_by_one, metres.one_by_one - 3) << where;
      EXPECT_GE(solved.near, metres.near) << where;
      EXPECT_GE(solved.one_by_one_near, metres.one_by_one_near - 1) << where;
    }
  }
}

// Returns the mean distance to a preferred posture, of radians and of lengths.
double OffThePosture(int seed, double size) {
  Sized s(seed, 9, size);
  const JointVector posture = RandomJoints(s.chain, &s.rng);
  double sum = 0;
  constexpr int kTargets = 30;
  for (int k = 0; k < kTargets; ++k) {
    const IkOptions options{
        .tolerance = s.tolerance(), .prefer = IkPrefer::kPosture, .posture = posture};
    const IkResult found = Ik(s.chain, s.chain.Fk(s.Near(posture, 1)), options);
    EXPECT_TRUE(found.success);
    double squares = 0;
    for (int i = 0; i < posture.size(); ++i)
      squares += std::pow((found.q[i] - posture[i]) / s.unit(i), 2);
    sum += std::sqrt(squares);
  }
  return sum / kTargets;
}

TEST(SizeOfChain, RedundantJointsApproachAPostureEquallyAtEverySize) {
  for (int seed = 0; seed < 4; ++seed) {
    const double metres = OffThePosture(seed, 1);
    for (const double size : {1e-3, 1e2, 1e4})
      EXPECT_NEAR(OffThePosture(seed, size), metres, 0.01 * metres) << seed << ", " << size;
  }
}

JointVector SpeedsAt(int seed, double size) {
  Sized s(seed, 7, size);
  const JointVector q = RandomJoints(s.chain, &s.rng);
  Twist twist;
  for (int i = 0; i < 3; ++i) {
    twist.linear[i] = size * s.rng.Uniform(-0.1, 0.1);
    twist.angular[i] = s.rng.Uniform(-0.1, 0.1);
  }
  JointVector speeds = DifferentialIk(s.chain, q, twist, {.seconds = 0.1, .posture = q}).velocity;
  for (int i = 0; i < speeds.size(); ++i) speeds[i] /= s.unit(i);
  return speeds;
}

TEST(SizeOfChain, DifferentialIkMovesSlidesByAsManyLengthsAtEverySize) {
  for (int seed = 0; seed < 20; ++seed) {
    const JointVector metres = SpeedsAt(seed, 1);
    for (const double size : {1e-3, 1e2, 1e4}) {
      const JointVector speeds = SpeedsAt(seed, size);
      for (int i = 0; i < speeds.size(); ++i)
        EXPECT_NEAR(speeds[i], metres[i], 1e-6) << seed << ", " << size << ", joint " << i;
    }
  }
}

}  // namespace
}  // namespace robocell
