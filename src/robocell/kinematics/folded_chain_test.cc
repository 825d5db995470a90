// Tests that a folded chain gives the same tip as the chain, for joints of all kinds.
#include "robocell/kinematics/folded_chain.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

Transform Whole(const PlainTransform& plain) {
  return {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(plain.rotation),
          Eigen::Map<const Eigen::Vector3d>(plain.translation)};
}

Transform About(const Eigen::Vector3d& axis, double angle) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

Transform Along(const Eigen::Vector3d& axis, double distance) {
  return {Eigen::Matrix3d::Identity(), axis * distance};
}

// Computes the tip as folded_chain.h defines it, term by term.
Transform Tip(const FoldedChain& chain, const JointVector& q) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  Transform tip = Whole(chain.base);
  for (int i = 0; i < chain.n; ++i) {
    const FoldedJoint& joint = chain.joints[i];
    if (i > 0 && joint.whole_link) tip = tip * Whole(joint.link);
    if (i > 0 && !joint.whole_link) {
      tip = tip * Along(x, joint.normal_length) *
            About(x, std::atan2(joint.sin_twist, joint.cos_twist));
    }
    tip = tip * About(z, joint.angle + (joint.slide ? 0 : q[i])) *
          Along(z, joint.shift + (joint.slide ? q[i] * chain.per_metre : 0));
  }
  tip = tip * Whole(chain.tip);
  tip.translation /= chain.per_metre;
  return tip;
}

void ExpectSameTip(const ChainModel& chain, const JointVector& q, double tolerance) {
  const Transform expected = WalkChain(chain, q.data(), [](int, const Transform&) {});
  const Transform folded = Tip(Fold(chain), q);
  EXPECT_LT((folded.rotation - expected.rotation).norm(), tolerance);
  EXPECT_LT((folded.translation - expected.translation).norm(), tolerance * chain.length);
}

TEST(FoldedChain, MatchesTheTipOfRandomChains) {
  Rng rng = Rng::Stream(1, "folded");
  for (int k = 0; k < 40; ++k) {
    const TestModel t = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 1 + k % 12, .slide_share = 0.1 * (k % 4)}).Write());
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    JointVector q(chain.n_joints());
    for (int draw = 0; draw < 5; ++draw) {
      for (double& v : q) v = rng.Uniform(-4, 4);
      ExpectSameTip(chain.model(), q, 1e-12);
    }
  }
}

// Covers parallel, antiparallel and nearly parallel axes.
TEST(FoldedChain, LosesNoDigitsWhereAxesAreNearlyParallel) {
  Rng rng = Rng::Stream(2, "parallel");
  const Eigen::Vector3d tilted = Eigen::Vector3d(0.6, 0.8, 0);
  for (const double off : {0.0, 1e-15, 1e-13, 1e-9, 1e-6, 1e-3, 0.0199, 0.0201, 0.1}) {
    for (const double turn : {0.0, std::acos(-1.0)}) {
      ChainModel chain;
      chain.n = 3;
      chain.length = 0.7;
      for (int i = 0; i < 3; ++i) {
        chain.joints[i].fixed = {Eigen::AngleAxisd(turn + off, tilted).toRotationMatrix(),
                                 Eigen::Vector3d(0.3, -0.2, 0.4)};
        chain.joints[i].reference = 0.1 * i;
      }
      chain.last_to_tip.translation = {0.1, 0, 0.05};
      for (int draw = 0; draw < 5; ++draw) {
        const JointVector q = {rng.Uniform(-3, 3), rng.Uniform(-3, 3), rng.Uniform(-3, 3)};
        ExpectSameTip(chain, q, 2e-13);
      }
    }
  }
}

}  // namespace
}  // namespace robocell::internal
