// Tests inverse kinematics in lanes on every instruction set of this processor: claimed solutions
// are correct and within the limits, and the success rate is high enough.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/lane_kernel.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell::internal {
namespace {

struct Queries {
  TestModel model;
  Chain chain;
  std::vector<Pose> targets;

  Queries(Rng* rng, int joints, int count)
      : model(TestModel::FromXml(
            RandomChainXml(rng, {.joints = joints, .slide_share = 0.1, .awkward = false}).Write())),
        chain(model.model(), "base", ChainTip::Site("tip")) {
    for (int k = 0; k < count; ++k) {
      model.Randomise(rng);
      targets.push_back(chain.Fk(model.ChainPositions(chain)));
    }
  }

  // Checks that the unfolded chain reaches the target within all limits.
  void ExpectIsAnswer(const Pose& target, std::span<const double> q) const {
    const Pose off = target.inverse() * chain.Fk(q);
    EXPECT_LE(off.translation().norm(), 1.001e-5);
    EXPECT_LE(off.angle(), 1.001e-5);
    for (int i = 0; i < chain.n_joints(); ++i) {
      EXPECT_GE(q[i], chain.joints()[i].lower);
      EXPECT_LE(q[i], chain.joints()[i].upper);
    }
  }
};

TEST(LaneTargets, SolveTheSameQueries) {
  for (const int joints : {6, 7, 9}) {
    Rng rng = Rng::Stream(joints, "lane targets");
    const Queries queries(&rng, joints, 60);
    OnEveryInstructionSet([&](const std::string&) {
      const IkBatchResult batch = IkBatch(queries.chain, queries.targets, {}, {});
      int solved = 0;
      for (int k = 0; k < batch.size; ++k) {
        if (!batch.success[k]) continue;
        ++solved;
        queries.ExpectIsAnswer(queries.targets[k], std::span(batch.q).subspan(k * joints, joints));
      }
      EXPECT_GE(solved, 59) << joints << " joints";
      for (int k = 0; k < 5; ++k) {
        const IkResult one = Ik(queries.chain, queries.targets[k], {});
        if (one.success) queries.ExpectIsAnswer(queries.targets[k], one.q);
      }
    });
  }
}

// Rounding occasionally leads a search to another solution; usually it is the same one.
TEST(LaneTargets, FindTheSameSolutionsUpToRounding) {
  constexpr int kCount = 200;
  for (const int joints : {6, 7, 9}) {
    Rng rng = Rng::Stream(joints, "lane targets agree");
    const Queries queries(&rng, joints, kCount);
    std::vector<double> near;  // from which no joint moves far
    for (const Pose& target : queries.targets) {
      const IkResult found = Ik(queries.chain, target, {});
      for (const double q : found.q) near.push_back(q + rng.Uniform(-0.02, 0.02));
    }
    std::optional<IkBatchResult> first, first_near;
    OnEveryInstructionSet([&](const std::string& name) {
      const auto count_same = [&](const IkBatchResult& a, const IkBatchResult& b) {
        int same = 0;
        for (int k = 0; k < kCount; ++k) {
          double apart = 0;
          for (int i = 0; i < joints; ++i)
            apart = std::max(apart, std::abs(a.row(k)[i] - b.row(k)[i]));
          same += apart < 1e-3;
        }
        return same;
      };
      const IkBatchResult cold = IkBatch(queries.chain, queries.targets, {}, {});
      const IkBatchResult warm = IkBatch(queries.chain, queries.targets, near, {});
      if (!first) first = cold, first_near = warm;
      EXPECT_GE(count_same(*first, cold), 0.95 * kCount) << name << ", " << joints << " joints";
      EXPECT_GE(count_same(*first_near, warm), 0.98 * kCount) << name << ", " << joints;
    });
  }
}

TEST(LaneTargets, MeetObjectivesBeyondAPose) {
  for (const int joints : {6, 8}) {
    Rng rng = Rng::Stream(joints, "lane objectives");
    const Queries queries(&rng, joints, 40);
    const IkFilter half = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
      for (int k = 0; k < count; ++k) keep[k] = std::cos(q[k * (q.size() / count)]) > -0.9;
    };
    OnEveryInstructionSet([&](const std::string& name) {
      for (const IkOptions& options :
           {IkOptions{.prefer = IkPrefer::kAwayFromLimits},
            IkOptions{.prefer = IkPrefer::kManipulability}, IkOptions{.filter = half}}) {
        const IkBatchResult batch = IkBatch(queries.chain, queries.targets, {}, {.ik = options});
        for (int k = 0; k < batch.size; ++k) {
          if (batch.success[k]) queries.ExpectIsAnswer(queries.targets[k], batch.row(k));
        }
        EXPECT_GE(batch.solved(), options.filter ? 30 : 39) << name;
      }
      const IkOptions cone{.axis = Eigen::Vector3d::UnitX(), .cone = 0.3};
      const IkBatchResult batch = IkBatch(queries.chain, queries.targets, {}, {.ik = cone});
      EXPECT_GE(batch.solved(), 39) << name;
      for (int k = 0; k < batch.size; ++k) {
        if (!batch.success[k]) continue;
        const Pose off = queries.targets[k].inverse() * queries.chain.Fk(batch.row(k));
        EXPECT_LE(off.translation().norm(), 1.001e-5) << name;
        EXPECT_GE(off.rotation()(0, 0), std::cos(0.3 + 1.001e-5)) << name;
      }
    });
  }
}

TEST(LaneTargets, UseTheLaneCountOfTheInstructionSet) {
  std::vector<int> lanes;
  OnEveryInstructionSet([&](const std::string&) {
    lanes.push_back(LaneCount());
    EXPECT_LE(LaneCount(), kMaxLanes);
    EXPECT_EQ(LaneCount() % LanesOfOneQuery(), 0);
  });
  ASSERT_FALSE(lanes.empty());
  EXPECT_TRUE(std::ranges::is_sorted(lanes, std::greater<>()));
}

}  // namespace
}  // namespace robocell::internal
