// Tests pairs of grasps for two hands.
#include "robocell/task/two_arm_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <vector>

#include "robocell/task/testing/two_hands.h"

namespace robocell {
namespace {

// Hands that hang with their fingers down would be needed to hold: these point along z, so that grasps
// from above are none of theirs.
class TwoArmMotionTest : public TwoHandsTest {};

TEST_F(TwoArmMotionTest, PairsAreAtTheTwoEndsOfTheBar) {
  Hold(false, false, Lying());
  const std::array<Robot, 2> arms = {Robot::Of(*scene_, "hands/left"),
                                     Robot::Of(*scene_, "hands/right")};
  const std::vector<internal::PairGrasp> pairs = internal::PairGrasps(*scene_, arms, "bar");
  ASSERT_FALSE(pairs.empty());
  for (size_t i = 0; i < pairs.size(); ++i) {
    // The left hand is at positive y.
    EXPECT_GT(pairs[i].of[0].tcp_in_body.translation().y(), 0.03);
    EXPECT_LT(pairs[i].of[1].tcp_in_body.translation().y(), -0.03);
    EXPECT_LT(pairs[i].of[0].approach.z(), -0.5);
    if (i > 0) EXPECT_GE(pairs[i].cost, pairs[i - 1].cost);
  }
}

}  // namespace
}  // namespace robocell
