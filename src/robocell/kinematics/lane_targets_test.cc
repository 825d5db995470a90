// Inverse kinematics in lanes on every instruction set that this processor has: what is reported
// solved is solved, inside of the limits, and as many are.
#include <gtest/gtest.h>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/lane_kernel.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

struct Questions {
  TestModel model;
  Chain chain;
  std::vector<Pose> targets;

  Questions(Rng* rng, int joints, int count)
      : model(TestModel::FromXml(
            RandomChainXml(rng, {.joints = joints, .slide_share = 0.1, .awkward = false}).Write())),
        chain(model.model(), "base", ChainTip::Site("tip")) {
    for (int k = 0; k < count; ++k) {
      model.Randomise(rng);
      targets.push_back(chain.Fk(model.ChainPositions(chain)));
    }
  }

  // The target is reached as the unfolded chain has it, and no limit is crossed.
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

TEST(LaneTargets, SolveTheSameQuestions) {
  for (const int joints : {6, 7, 9}) {
    Rng rng = Rng::Stream(joints, "lane targets");
    const Questions questions(&rng, joints, 60);
    OnEveryInstructionSet([&](const std::string&) {
      const IkBatchResult batch = IkBatch(questions.chain, questions.targets, {}, {});
      int solved = 0;
      for (int k = 0; k < batch.size; ++k) {
        if (!batch.success[k]) continue;
        ++solved;
        questions.ExpectIsAnswer(questions.targets[k],
                                 std::span(batch.q).subspan(k * joints, joints));
      }
      EXPECT_GE(solved, 59) << joints << " joints";
      for (int k = 0; k < 5; ++k) {
        const IkResult one = Ik(questions.chain, questions.targets[k], {});
        if (one.success) questions.ExpectIsAnswer(questions.targets[k], one.q);
      }
    });
  }
}

TEST(LaneTargets, HaveLanesOfTheirOwnNumber) {
  std::vector<int> lanes;
  OnEveryInstructionSet([&](const std::string&) {
    lanes.push_back(LaneCount());
    EXPECT_LE(LaneCount(), kMaxLanes);
    EXPECT_EQ(LaneCount() % GroupOfLanes(), 0);
  });
  ASSERT_FALSE(lanes.empty());
  EXPECT_TRUE(std::ranges::is_sorted(lanes, std::greater<>()));
}

}  // namespace
}  // namespace robocell
