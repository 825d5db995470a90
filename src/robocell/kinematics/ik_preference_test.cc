#include "robocell/kinematics/ik_preference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/random_chain_ik.h"
#include "robocell/testing/decompositions.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

// Returns the cost of the preference in the options; lower is better.
double Badness(const Chain& chain, const IkOptions& options, std::span<const double> q) {
  if (options.prefer == IkPrefer::kManipulability) return -Manipulability(chain, q);
  if (options.prefer != IkPrefer::kAwayFromLimits) {
    JointVector near = options.prefer == IkPrefer::kSeed ? options.seed : options.posture;
    for (int i = 0; i < near.size(); ++i)
      near[i] = std::clamp(near[i], chain.joints()[i].lower, chain.joints()[i].upper);
    return SquaredDistance(q, near);
  }
  double sum = 0;
  for (int i = 0; i < chain.n_joints(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    if (!joint.limited) continue;
    const double half = 0.5 * (joint.upper - joint.lower);
    sum += std::pow((q[i] - joint.lower - half) / half, 2);
  }
  return sum;
}

class IkPrefers : public IkOfRandomChain {
 protected:
  IkPrefers() : IkOfRandomChain(1) {}
};
INSTANTIATE_TEST_SUITE_P(Joints, IkPrefers, testing::Values(6, 7, 9));

class IkPrefersWithRedundancy : public IkPrefers {};
INSTANTIATE_TEST_SUITE_P(Joints, IkPrefersWithRedundancy, testing::Values(7, 9));

TEST_P(IkPrefers, ImprovesOnTheFirstSolution) {
  for (const IkPrefer prefer : {IkPrefer::kSeed, IkPrefer::kPosture, IkPrefer::kAwayFromLimits,
                                IkPrefer::kManipulability}) {
    double first = 0, chosen = 0;
    int solved = 0, worse = 0;
    for (int k = 0; k < 40; ++k) {
      const Pose target = Reached();
      IkOptions options{.seed = RandomJoints(chain_, &rng_), .prefer = prefer};
      if (prefer == IkPrefer::kPosture) options.posture = RandomJoints(chain_, &rng_);
      const IkResult plain = Ik(chain_, target, {.seed = options.seed});
      const IkResult best = Ik(chain_, target, options);
      EXPECT_TRUE(InLimits(chain_, best.q));
      if (!plain.success || !best.success) continue;
      EXPECT_TRUE(EngineAgrees(model_, chain_, target, best.q, kNear));
      ++solved;
      const double before = Badness(chain_, options, plain.q);
      const double after = Badness(chain_, options, best.q);
      worse += after > before + 1e-9;
      first += before;
      chosen += after;
    }
    EXPECT_GE(solved, 39);
    EXPECT_LE(worse, 4) << static_cast<int>(prefer);  // the first solution may be lucky
    // Six joints have a handful of solutions to choose from.
    const double better = chain_.n_joints() == 6 ? 0 : 0.1 * std::abs(first);
    EXPECT_LT(chosen, first - better) << static_cast<int>(prefer);
  }
}

// With redundant joints no better solution is near: a step along any direction that does not move
// the tip is not an improvement.
TEST_P(IkPrefersWithRedundancy, IsOptimalWithinTheNullSpace) {
  for (const IkPrefer prefer : {IkPrefer::kPosture, IkPrefer::kAwayFromLimits}) {
    int settled = 0, counted = 0;
    for (int k = 0; k < 60; ++k) {
      IkOptions options{.prefer = prefer};
      const JointVector truth = RandomJoints(chain_, &rng_);
      if (prefer == IkPrefer::kPosture) {
        options.posture = truth;
        for (double& v : options.posture) v += rng_.Uniform(-0.3, 0.3);
      }
      const IkResult best = Ik(chain_, chain_.Fk(truth), options);
      if (!best.success) continue;
      bool at_limit = false;
      for (int i = 0; i < best.q.size(); ++i) {
        const ChainJoint& joint = chain_.joints()[i];
        at_limit |= best.q[i] < joint.lower + 0.02 || best.q[i] > joint.upper - 0.02;
      }
      if (at_limit) continue;
      ++counted;
      Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, chain_.n_joints());
      chain_.Jacobian(best.q, jacobian);
      const Eigen::MatrixXd spare = NullSpaceOf(jacobian);
      bool best_here = true;
      for (Eigen::Index c = 0; c < spare.cols(); ++c) {
        for (const double step : {-0.02, 0.02}) {
          JointVector moved = best.q;
          for (int i = 0; i < moved.size(); ++i) moved[i] += step * spare(i, c);
          best_here &= Badness(chain_, options, moved) > Badness(chain_, options, best.q);
        }
      }
      settled += best_here;
    }
    EXPECT_GE(counted, 10);
    // With many redundant joints some still move after the allowed steps.
    const double share = prefer == IkPrefer::kPosture ? 0.95 : 0.9;
    EXPECT_GE(settled, share * counted) << static_cast<int>(prefer);
  }
}

// An unreachable target is approached by the residuals of the query: if any rotation is accepted,
// the target's rotation makes no difference.
TEST_P(IkPrefers, IgnoresThePreferenceOutOfReach) {
  const IkFilter all = [](std::span<const double>, int, std::span<uint8_t> keep) {
    std::fill(keep.begin(), keep.end(), uint8_t{1});
  };
  std::vector<Pose> targets, turned;
  for (int k = 0; k < 40; ++k) {
    const Vector3d there = 1.2 * chain_.model().reach_bound * RandomDirection();
    targets.emplace_back(there, Reached().quaternion());
    turned.emplace_back(there, Reached().quaternion());
  }
  for (const IkOptions& options :
       {IkOptions{.position_only = true},
        IkOptions{.position_only = true, .prefer = IkPrefer::kAwayFromLimits},
        IkOptions{.position_only = true, .filter = all}}) {
    const IkBatchResult found = IkBatch(chain_, targets, {}, {.ik = options}),
                        other = IkBatch(chain_, turned, {}, {.ik = options});
    for (int b = 0; b < found.size; ++b) {
      EXPECT_FALSE(found.success[b]);
      EXPECT_TRUE(InLimits(chain_, found.row(b)));
      EXPECT_NEAR(found.position_error[b],
                  (chain_.Fk(found.row(b)).translation() - targets[b].translation()).norm(), 1e-9);
      EXPECT_NEAR(found.position_error[b], other.position_error[b], 1e-9);
    }
  }
}

TEST_P(IkPrefers, IsTheSameAloneInABatchAndOnThreads) {
  std::vector<Pose> targets;
  for (int b = 0; b < 150; ++b)
    targets.push_back(b % 7 == 6 ? Pose(Vector3d(40, b, 0)) : Reached());
  const IkFilter right = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (int k = 0; k < count; ++k) keep[k] = q[k * (q.size() / count)] > 0;
  };
  JointVector seed(chain_.n_joints(), 0.1);
  for (const IkOptions& options :
       {IkOptions{.prefer = IkPrefer::kSeed},
        IkOptions{.axis = Vector3d::UnitX(), .cone = 0.1, .prefer = IkPrefer::kAwayFromLimits},
        IkOptions{.position_weights = {1, 0.5, 0}}, IkOptions{.filter = right},
        IkOptions{.prefer = IkPrefer::kManipulability, .max_restarts = 16}}) {
    const IkBatchResult all = IkBatch(chain_, targets, seed, {.ik = options});
    const IkBatchResult threaded = IkBatch(chain_, targets, seed, {.ik = options, .threads = 3});
    EXPECT_EQ(all.q, threaded.q);
    EXPECT_EQ(all.iterations, threaded.iterations);
    std::vector<Pose> backwards(targets.rbegin(), targets.rend());
    const IkBatchResult reversed = IkBatch(chain_, backwards, seed, {.ik = options});
    for (int b = 0; b < all.size; b += 13) {
      EXPECT_TRUE(std::ranges::equal(all.row(b), reversed.row(all.size - 1 - b)));
      const IkBatchResult alone = IkBatch(chain_, {&targets[b], 1}, seed, {.ik = options});
      EXPECT_EQ(alone.success[0], all.success[b]);
      EXPECT_TRUE(std::ranges::equal(alone.q, all.row(b)));
    }
  }
}

}  // namespace
}  // namespace robocell::internal
