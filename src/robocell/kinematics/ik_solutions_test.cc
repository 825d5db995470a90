#include "robocell/kinematics/ik_solutions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/random_chain_ik.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

class IkSolutionsOfRandomChain : public IkOfRandomChain {};
INSTANTIATE_TEST_SUITE_P(Joints, IkSolutionsOfRandomChain, testing::Values(6, 7, 9));

TEST_P(IkSolutionsOfRandomChain, AreDistinctCorrectAndSortedByDistance) {
  const JointVector seed = RandomJoints(chain_, &rng_);
  for (int k = 0; k < 5; ++k) {
    const JointVector truth = RandomJoints(chain_, &rng_);
    const Pose target = chain_.Fk(truth);
    const std::vector<IkResult> all =
        IkSolutions(chain_, target, {.seed = seed, .max_restarts = 400});
    ASSERT_FALSE(all.empty());
    for (std::size_t a = 0; a < all.size(); ++a) {
      EXPECT_TRUE(EngineAgrees(model_, chain_, target, all[a].q, kNear));
      EXPECT_TRUE(InLimits(chain_, all[a].q));
      if (a > 0) {
        EXPECT_GE(SquaredDistance(all[a].q, seed), SquaredDistance(all[a - 1].q, seed));
      }
      for (std::size_t b = 0; b < a; ++b) {
        double apart = 0;
        for (int i = 0; i < seed.size(); ++i)
          apart = std::max(apart, std::abs(all[a].q[i] - all[b].q[i]));
        EXPECT_GT(apart, 0.05);
      }
    }
  }
}

TEST_P(IkSolutionsOfRandomChain, EndWithTheExceptionOfTheirPoll) {
  int polls = 0;
  const auto poll = [&] {
    if (++polls == 3) throw Error("interrupted");
  };
  const IkOptions many{.max_restarts = 999};
  ExpectThrow<Error>([&] { IkSolutions(chain_, Reached(), many, 0.05, poll); }, "interrupted");
  EXPECT_EQ(polls, 3);
}

// Elbow up and elbow down, and nothing else: known in closed form.
TEST(IkSolutionsOfTwoLinks, AreBothElbows) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
      "<body><joint axis='0 0 1' range='-3.1 3.1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1' range='-3.1 3.1'/><geom size='.1'/>"
      "<site name='tip' pos='1 0 0'/></body></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const double elbow = 1.2, shoulder = 0.4;
  const Pose target = chain.Fk(JointVector{shoulder, elbow});
  std::vector<IkResult> all = IkSolutions(chain, target, {.position_only = true});
  ASSERT_EQ(all.size(), 2u);
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.q[1] > b.q[1]; });
  EXPECT_NEAR(all[0].q[0], shoulder, 1e-4);
  EXPECT_NEAR(all[0].q[1], elbow, 1e-4);
  EXPECT_NEAR(all[1].q[0], shoulder + elbow, 1e-4);
  EXPECT_NEAR(all[1].q[1], -elbow, 1e-4);
  EXPECT_EQ(IkSolutions(chain, Pose(Vector3d(3, 0, 0)), {.position_only = true}).size(), 0u);
  const IkFilter up = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (int k = 0; k < count; ++k) keep[k] = q[2 * k + 1] > 0;
  };
  EXPECT_EQ(IkSolutions(chain, target, {.position_only = true, .filter = up}).size(), 1u);
  // Yoshikawa's textbook case: l1 l2 |sin(elbow)|, for the position. With the rotation it is a 3 x
  // 2 task.
  Eigen::Matrix<double, 6, 2> j;
  chain.Jacobian(all[0].q, j);
  EXPECT_NEAR(Manipulability(chain, all[0].q), std::sqrt((j.transpose() * j).determinant()), 1e-12);
}

// One redundant joint: solutions all around the turn, which begins again half a turn from the seed.
TEST(IkSolutionsOfThreeLinks, ExcludeWholeTurns) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><compiler angle='radian'/><worldbody><body name='base'><geom size='.1'/>"
      "<body><joint axis='0 0 1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1'/><geom size='.1'/>"
      "<body pos='1 0 0'><joint axis='0 0 1' range='-9 9'/><geom size='.1'/>"
      "<site name='tip' pos='1 0 0'/></body></body></body></body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const std::vector<IkResult> all =
      IkSolutions(chain, Pose(Vector3d(0.4, 0.3, 0)),
                  {.seed = JointVector(3), .position_only = true, .max_restarts = 400}, 0.3);
  EXPECT_GT(all.size(), 10u);
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double apart = 0;
      for (int i = 0; i < 3; ++i) {
        const double difference = all[a].q[i] - all[b].q[i];
        apart = std::max(apart, std::abs(std::remainder(difference, 2 * std::numbers::pi)));
      }
      EXPECT_GT(apart, 0.3);
    }
  }
}

}  // namespace
}  // namespace robocell
