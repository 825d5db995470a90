// Tests two arms on one path.
#include "robocell/expert/arm_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/task/testing/two_hands.h"

namespace robocell {
namespace {

class ArmPairTest : public TwoHandsTest {
 protected:
  internal::ArmPair Pair() { return {*scene_, {"hands/left", "hands/right"}, 0.05}; }
};

// Both are at the same share of the way at any time, and stand still at both ends.
TEST_F(ArmPairTest, MovesBothTogether) {
  internal::ArmPair pair = Pair();
  EXPECT_EQ(pair.target(), std::vector<double>({0, 0}));
  pair.Follow({{0.1, -0.05}, {0.2, -0.1}}, 0.5, 0.5);
  double last = 0, first_step = 0, largest = 0;
  int ticks = 0;
  while (!pair.finished()) {
    pair.Next();
    const std::vector<double> q = pair.target();
    EXPECT_NEAR(q[1], -q[0] / 2, 1e-12);
    EXPECT_GE(q[0], last);
    if (ticks++ == 0) first_step = q[0];
    largest = std::max(largest, q[0] - last);
    last = q[0];
  }
  EXPECT_EQ(pair.target(), std::vector<double>({0.2, -0.1}));
  EXPECT_LT(first_step, largest / 4);
  EXPECT_LE(largest / 0.05, 0.5 * 1.01) << "the fastest joint keeps to the speed";
}

TEST_F(ArmPairTest, CommandsEachHandOfItsOwn) {
  internal::ArmPair pair = Pair();
  pair.SetOpening(0, 1, 100);
  pair.SetOpening(1, 0, 100);
  pair.Next();
  const RobotAction action = pair.Command().at("hands");
  EXPECT_EQ(action.at("left_hand").values.at(0), 1);
  EXPECT_EQ(action.at("right_hand").values.at(0), 0);
  EXPECT_TRUE(action.contains("left"));
  EXPECT_TRUE(action.contains("right"));
  EXPECT_TRUE(pair.openings_reached());
  EXPECT_EQ(pair.HandOf(1), "r");
}

}  // namespace
}  // namespace robocell
