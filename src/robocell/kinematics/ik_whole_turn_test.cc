// Tests hinges whose limits span a whole turn or more: motion beyond a limit continues a turn away.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

constexpr double kHalfATurn = std::numbers::pi, kOneTurn = 2 * kHalfATurn;

// Returns the same arm each time, of hinges that all have these limits.
TestModel ArmOfTurns(int joints, const std::string& limits) {
  Rng rng = Rng::Stream(joints, "whole turns");
  std::string xml = "<mujoco><compiler angle='radian'/><worldbody><body name='base'>";
  const auto place = [&] {
    return fmt::format("pos='{} {} {}' quat='{} {} {} {}'", rng.Uniform(-.3, .3),
                       rng.Uniform(-.3, .3), rng.Uniform(-.3, .3), rng.Normal(), rng.Normal(),
                       rng.Normal(), rng.Normal());
  };
  for (int i = 0; i < joints; ++i)
    xml += fmt::format("<body {}><geom size='.05'/><joint axis='0 0 1' {}/>", place(), limits);
  xml += fmt::format("<site name='tip' {}/>", place());
  for (int i = 0; i <= joints; ++i) xml += "</body>";
  return TestModel::FromXml(xml + "</worldbody></mujoco>");
}

std::string Limits(double lower, double upper) {
  return fmt::format("range='{} {}'", lower, upper);
}

class IkOfWholeTurns : public testing::TestWithParam<int> {
 protected:
  static Chain ChainOf(const TestModel& t) { return {t.model(), "base", ChainTip::Site("tip")}; }
  std::vector<Pose> Reached(const Chain& chain, int count) {
    std::vector<Pose> targets;
    for (int b = 0; b < count; ++b) targets.push_back(chain.Fk(RandomJoints(chain, &rng_)));
    return targets;
  }

  Rng rng_ = Rng::Stream(GetParam(), "questions about whole turns");
};
INSTANTIATE_TEST_SUITE_P(Joints, IkOfWholeTurns, testing::Values(3, 6, 7, 9));

TEST_P(IkOfWholeTurns, TakesAsManyStepsAsWithoutLimits) {
  const TestModel limited_arm = ArmOfTurns(GetParam(), Limits(-kHalfATurn, kHalfATurn)),
                  endless_arm = ArmOfTurns(GetParam(), "");
  const Chain limited = ChainOf(limited_arm), endless = ChainOf(endless_arm);
  const std::vector<Pose> targets = Reached(limited, 2000);
  const IkBatchResult in_limits = IkBatch(limited, targets), anywhere = IkBatch(endless, targets);
  EXPECT_EQ(in_limits.success, anywhere.success);
  EXPECT_EQ(in_limits.iterations, anywhere.iterations);
  for (int b = 0; b < in_limits.size; ++b) {
    EXPECT_TRUE(InLimits(limited, in_limits.row(b)));
    for (int i = 0; i < GetParam(); ++i) {
      const double off = in_limits.row(b)[i] - anywhere.row(b)[i];
      EXPECT_NEAR(std::remainder(off, kOneTurn), 0, 1e-12);
    }
  }
}

// Turns begin anywhere, so that values at their ends are rounded up and down.
TEST_P(IkOfWholeTurns, RoundingViolatesNoLimit) {
  int solved = 0, count = 0;
  for (int k = 0; k < 20; ++k) {
    const double lower = rng_.Uniform(-9, 3);
    const TestModel arm = ArmOfTurns(GetParam(), Limits(lower, lower + kOneTurn));
    const Chain chain = ChainOf(arm);
    // Joints are at the ends, or within some digits of them.
    std::vector<Pose> targets;
    for (int b = 0; b < 100; ++b) {
      JointVector q(GetParam());
      for (double& value : q) {
        const double in = std::pow(10.0, rng_.Uniform(-17, 0));
        value = rng_.Uniform() < 0.5 ? lower + in : lower + kOneTurn - in;
      }
      targets.push_back(chain.Fk(q));
    }
    const IkBatchResult found = IkBatch(chain, targets);
    for (int b = 0; b < found.size; ++b) {
      EXPECT_TRUE(InLimits(chain, found.row(b)));
      if (found.success[b]) {
        EXPECT_TRUE(EngineAgrees(arm, chain, targets[b], found.row(b), 1.0001e-5));
      }
    }
    solved += found.solved();
    count += found.size;
  }
  EXPECT_GE(solved, count - 2);
}

// A seed at a limit leads to a solution near it: solutions beyond would be a turn away.
TEST_P(IkOfWholeTurns, StaysNearASeedAtALimit) {
  const TestModel arm = ArmOfTurns(GetParam(), Limits(-kOneTurn, kOneTurn));
  const Chain chain = ChainOf(arm);
  for (const double end : {-kOneTurn, kOneTurn}) {
    int far = 0;
    for (int k = 0; k < 100; ++k) {
      JointVector seed = RandomJoints(chain, &rng_);
      seed[k % seed.size()] = end;
      JointVector goal = seed;
      for (double& value : goal)
        value = std::clamp(value + rng_.Uniform(-0.005, 0.005), -kOneTurn, kOneTurn);
      const IkResult alone = Ik(chain, chain.Fk(goal), {.seed = seed});
      const IkBatchResult batch = IkBatch(chain, std::vector{chain.Fk(goal)}, seed);
      for (const std::span<const double> q : {std::span<const double>(alone.q), batch.row(0)}) {
        EXPECT_TRUE(InLimits(chain, q));
        double off = 0;
        for (int i = 0; i < seed.size(); ++i) off = std::max(off, std::abs(q[i] - seed[i]));
        far += off > kHalfATurn;
      }
    }
    EXPECT_LE(far, 4);
  }
}

}  // namespace
}  // namespace robocell
