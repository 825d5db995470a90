// Tests the gradient of manipulability against differences, and batches against single
// configurations.
#include "robocell/kinematics/manipulability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

TEST(LogManipulabilityGradient, MatchesFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (const int joints : {1, 2, 4, 5, 6, 7, 9, 12}) {
    Rng rng = Rng::Stream(joints, "manipulability");
    const TestModel t =
        TestModel::FromXml(RandomChainXml(&rng, {.joints = joints, .slide_share = 0.25}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    for (int k = 0; k < 20; ++k) {
      const JointVector q = RandomJoints(chain, &rng);
      JointVector gradient(joints);
      LogManipulabilityGradient(chain.model(), q.data(), gradient.data());
      for (int i = 0; i < joints; ++i) {
        JointVector after = q, before = q;
        after[i] += kStep;
        before[i] -= kStep;
        const double slope =
            std::log(Manipulability(chain, after) / Manipulability(chain, before)) / (2 * kStep);
        EXPECT_NEAR(gradient[i], slope, 1e-5 * (1 + std::abs(slope) + slope * slope))
            << joints << " joints, joint " << i;
      }
    }
  }
}

// Two parallel slides and a hinge: there is nothing to divide by.
TEST(LogManipulabilityGradient, IsFiniteAtASingularity) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><worldbody><body name='base'><geom size='.1'/><body><joint type='slide'/>"
      "<geom size='.1'/><body><joint type='slide'/><geom size='.1'/><body><joint axis='1 0 0'/>"
      "<geom size='.1'/><site name='tip' pos='0 .3 0'/></body></body></body></body></worldbody>"
      "</mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  JointVector gradient(3);
  LogManipulabilityGradient(chain.model(), JointVector{0, 0, 0}.data(), gradient.data());
  for (const double slope : gradient) EXPECT_TRUE(std::isfinite(slope));
  EXPECT_LT(Manipulability(chain, JointVector{0, 0, 0}), 1e-9);
}

TEST(ManipulabilityBatch, MatchesSingleConfigurationsAtSingularities) {
  const TestModel t = TestModel::FromXml(
      "<mujoco><default><geom size='.1'/></default><worldbody><body name='base'><geom/>"
      "<body><joint axis='0 0 1'/><geom/><body><joint axis='0 1 0'/><geom/><body pos='0 0 .4'>"
      "<joint axis='0 0 1'/><geom/><body><joint axis='0 1 0'/><geom/><body pos='0 0 .3'>"
      "<joint axis='0 0 1'/><geom/><body><joint axis='0 1 0'/><geom/><body><joint axis='0 0 1'/>"
      "<geom/><site name='tip' pos='.1 0 .1'/></body></body></body></body></body></body></body>"
      "</body></worldbody></mujoco>");
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  Rng rng = Rng::Stream(1, "manipulability batch");
  std::vector<double> q(7);  // stretched
  for (int k = 0; k < 20; ++k) {
    const JointVector some = RandomJoints(chain, &rng);
    q.insert(q.end(), some.begin(), some.end());
  }
  std::vector<double> values(21);
  OnEveryInstructionSet([&](const std::string&) {
    ManipulabilityBatch(chain, q, values);
    EXPECT_LT(values[0], 1e-7);
    for (int k = 0; k < 21; ++k)
      EXPECT_NEAR(values[k], Manipulability(chain, std::span(q).subspan(7 * k, 7)), 1e-7);
  });
  std::vector<double> none;
  ManipulabilityBatch(chain, none, none);
  ExpectThrow<ArgumentError>([&] { ManipulabilityBatch(chain, none, values); },
                             "q: expected 7 numbers, or 7 for each of 21 configurations; got 0");
}

}  // namespace
}  // namespace robocell
