// Tests that normal frames have the chain's axes and tip, and that steps have the form in the
// header.
#include "robocell/kinematics/normal_frames.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

// Returns the point on the axis that is nearest to the base's origin.
Eigen::Vector3d FootOf(const ChainFrames& frames, int i) {
  return frames.origin[i] - frames.axis[i] * frames.axis[i].dot(frames.origin[i]);
}

void ExpectSameFrames(const ChainModel& chain, const JointVector& q, double tolerance) {
  ChainFrames expected, frames;
  ComputeFrames(chain, q.data(), &expected);
  ComputeFrames(InNormalFrames(chain), q.data(), &frames);
  EXPECT_LT((frames.tip.rotation - expected.tip.rotation).norm(), tolerance);
  EXPECT_LT((frames.tip.translation - expected.tip.translation).norm(), tolerance);
  for (int i = 0; i < chain.n; ++i) {
    EXPECT_LT((frames.axis[i] - expected.axis[i]).norm(), tolerance) << i;
    EXPECT_LT((FootOf(frames, i) - FootOf(expected, i)).norm(), tolerance) << i;
  }
}

TEST(NormalFrames, MatchRandomChains) {
  Rng rng = Rng::Stream(1, "normal frames");
  for (int k = 0; k < 40; ++k) {
    const TestModel t = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 1 + k % 12, .slide_share = 0.1 * (k % 4)}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    JointVector q(chain.n_joints());
    for (int draw = 0; draw < 5; ++draw) {
      for (double& v : q) v = rng.Uniform(-4, 4);
      ExpectSameFrames(chain.model(), q, 1e-12);
    }
  }
}

TEST(NormalFrames, MatchChainsWithNearlyParallelAxes) {
  Rng rng = Rng::Stream(2, "normal frames");
  for (const double off : {0.0, 1e-15, 1e-9, 1e-3, 0.0199, 0.0201, 0.1}) {
    for (const double turn : {0.0, std::acos(-1.0), std::acos(0.0)}) {
      ChainModel chain;
      chain.n = 4;
      for (int i = 0; i < chain.n; ++i) {
        const Eigen::Vector3d tilted(0.6, 0.8, 0);
        chain.joints[i].fixed = {Eigen::AngleAxisd(turn + off, tilted).toRotationMatrix(),
                                 Eigen::Vector3d(0.3, -0.2, 0.4)};
        chain.joints[i].reference = 0.1 * i;
        chain.joints[i].slide = i == 2;
      }
      chain.last_to_tip.translation = {0.1, 0, 0.05};
      for (int draw = 0; draw < 5; ++draw) {
        JointVector q(chain.n);
        for (double& v : q) v = rng.Uniform(-3, 3);
        ExpectSameFrames(chain, q, 1e-12);
      }
    }
  }
}

TEST(NormalFrames, StepAlongTheNormalAndTwistAboutIt) {
  Rng rng = Rng::Stream(3, "normal frames");
  const TestModel t =
      TestModel::FromXml(RandomChainXml(&rng, {.joints = 7, .slide_share = 0}).Write());
  const ChainModel chain = InNormalFrames(Chain(t.model(), "base", ChainTip::Site("tip")).model());
  for (int i = 1; i < chain.n; ++i) {
    const Transform& step = chain.joints[i].fixed;
    EXPECT_EQ(step.rotation.col(0), Eigen::Vector3d::UnitX()) << i;
    EXPECT_EQ(step.translation.y(), 0) << i;
  }
}

// Three pairs of axes that intersect up to rounding.
TEST(NormalFrames, HaveNoLengthsFromRoundingErrors) {
  ChainModel chain;
  chain.n = 4;
  const double third = std::acos(-1.0) / 3;
  for (int i = 1; i < chain.n; ++i) {
    const Eigen::AngleAxisd turn(third * i, Eigen::Vector3d(0.6, 0, 0.8));
    chain.joints[i].fixed.rotation = turn.toRotationMatrix();
    chain.joints[i].fixed.translation = Eigen::Vector3d(0.1 + 0.2 - 0.3, 0, 0.3 * (i == 2));
  }
  const ChainModel normal = InNormalFrames(chain);
  for (int i = 1; i < chain.n; ++i) {
    for (const double length : normal.joints[i].fixed.translation)
      EXPECT_TRUE(length == 0 || std::abs(length) > 1e-3) << i << ": " << length;
  }
}

}  // namespace
}  // namespace robocell::internal
