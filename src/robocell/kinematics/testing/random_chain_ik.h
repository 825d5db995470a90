// For tests only: queries about random chains, whose solutions the engine judges.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <span>
#include <vector>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell {

inline double SquaredDistance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return sum;
}

// Random chains; targets that each reaches, turned and moved so that only the requested part can be
// reached.
class IkOfRandomChain : public ::testing::TestWithParam<int> {
 protected:
  static constexpr double kTolerance = 1e-5, kNear = 1.0001 * kTolerance;

  explicit IkOfRandomChain(double limited_share = 0.8)
      : rng_(Rng::Stream(GetParam(), "more ik")),
        model_(TestModel::FromXml(
            RandomChainXml(&rng_,
                           {.joints = GetParam(), .slide_share = 0, .limited_share = limited_share})
                .Write())),
        chain_(model_.model(), "base", ChainTip::Site("tip")) {}

  Eigen::Vector3d RandomDirection() {
    return Eigen::Vector3d(rng_.Normal(), rng_.Normal(), rng_.Normal()).normalized();
  }
  Pose Reached() { return chain_.Fk(RandomJoints(chain_, &rng_)); }
  // Returns the tip by the engine, in the axes of the target.
  Transform TipSeenFrom(const Pose& target, std::span<const double> q) {
    for (int i = 0; i < chain_.n_joints(); ++i)
      model_.data()->qpos[chain_.joints()[i].qpos_address] = q[i];
    mj_kinematics(model_.model(), model_.data());
    return ToTransform(target).inverse() * model_.TipInBase(chain_);
  }
  // Solves single and batched queries and returns the share that was solved. Solutions must satisfy
  // `judge(tip in target)`.
  template <class Judge>
  double Solved(const std::vector<Pose>& targets, const IkOptions& options, const Judge& judge) {
    const IkBatchResult batch = IkBatch(chain_, targets, {}, {.ik = options});
    int good = 0, singles = 0;
    const auto check = [&](const Pose& target, std::span<const double> q, bool success) {
      EXPECT_TRUE(InLimits(chain_, q));
      if (!success) return 0;
      EXPECT_TRUE(judge(TipSeenFrom(target, q)));
      return 1;
    };
    for (int b = 0; b < batch.size; ++b) good += check(targets[b], batch.row(b), batch.success[b]);
    for (std::size_t b = 0; b < targets.size(); b += 5) {
      const IkResult one = Ik(chain_, targets[b], options);
      singles += check(targets[b], one.q, one.success);
    }
    EXPECT_GE(singles, 0.97 * static_cast<double>(targets.size()) / 5);
    return good / static_cast<double>(targets.size());
  }

  Rng rng_;
  TestModel model_;
  Chain chain_;
};

}  // namespace robocell
