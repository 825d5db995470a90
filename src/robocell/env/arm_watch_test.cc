// Tests when an arm counts as slow, near and at rest, as laws of sequences of positions.
#include "robocell/env/arm_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace robocell::internal {
namespace {

constexpr double kNearEnoughToWatch = 0.002, kWatchStep = 0.002;

// The watch's results for one joint with target 0 that is at `q(step)`.
struct SeenInSteps {
  int slow = 0, near = 0, at_rest = 0, steps = 0;
};

SeenInSteps LookAtOneJoint(const std::function<double(int)>& q, int steps = 500, double delay = 0) {
  ArmWatch watch({kNearEnoughToWatch}, kWatchStep, delay);
  const double wanted[] = {0}, start[] = {q(0)};
  watch.Begin(start, 0);
  SeenInSteps seen{.steps = steps};
  for (int i = 1; i <= steps; ++i) {
    const double now[] = {q(i)};
    watch.Look(now, wanted, i * kWatchStep);
    seen.slow += watch.is_slow();
    seen.near += watch.IsNear(wanted);
    seen.at_rest += watch.at_rest();
  }
  return seen;
}

TEST(ArmWatch, AJointThatStaysIsAtRestAfterAWindow) {
  const SeenInSteps seen = LookAtOneJoint([](int) { return 0.01; });
  EXPECT_EQ(seen.slow, seen.steps - 1) << "one step says nothing of its speed";
  EXPECT_EQ(seen.near, 0);
  EXPECT_NEAR(seen.at_rest, seen.steps - 50, 3);
}

TEST(ArmWatch, AJointThatHasNotBegunToMoveIsNotAtRest) {
  const SeenInSteps seen = LookAtOneJoint([](int) { return 0.01; }, 500, 0.3);
  EXPECT_NEAR(seen.at_rest, seen.steps - 50 - 150, 3);
}

TEST(ArmWatch, AJointThatMovesIsNeitherSlowNorAtRest) {
  const SeenInSteps seen = LookAtOneJoint([](int i) { return 0.5 - 0.05 * i * kWatchStep; });
  EXPECT_EQ(seen.slow, 0);
  EXPECT_EQ(seen.at_rest, 0);
}

TEST(ArmWatch, AJointThatCreepsToItsTargetIsNotAtRest) {
  const auto q = [](int i) { return 0.02 * std::exp(-i * kWatchStep / 0.3); };
  const SeenInSteps seen = LookAtOneJoint(q, 340);  // until it is near
  EXPECT_EQ(seen.near, 0);
  EXPECT_EQ(seen.at_rest, 0);
}

// Whatever part of the swing the windows begin in. A load of a tonne on soft servos.
TEST(ArmWatch, AJointThatTurnsBackFromASlowSwingIsNotAtRest) {
  for (int phase = 0; phase < 50; ++phase) {
    const auto q = [&](int i) {
      return 0.028 + 0.022 * std::cos(3.6 * kWatchStep * (i + phase - 300));
    };
    EXPECT_EQ(LookAtOneJoint(q, 870).at_rest, 0) << phase;  // a whole swing
  }
}

// The servos of a Panda move joint 7 back and forth by 0.22 mrad, in steps of 2 ms.
TEST(ArmWatch, AJointThatChattersAboutAPlaceIsAtRest) {
  for (const double away : {0.0, 0.0017, 0.0022, 0.01}) {
    for (const double by : {0.00022, 0.001}) {
      const auto q = [&](int i) { return away + (i % 2 == 0 ? by / 2 : -by / 2); };
      const SeenInSteps seen = LookAtOneJoint(q);
      EXPECT_EQ(seen.slow, seen.steps - 1);
      EXPECT_NEAR(seen.at_rest, seen.steps - 50, 3) << away << " " << by;
    }
  }
}

// Windows begin when a joint becomes slow, in any step, so they can have even and odd lengths.
TEST(ArmWatch, AChatteringJointIsAtRestWheneverItsWindowsBegin) {
  for (int moving = 20; moving < 24; ++moving) {
    const auto q = [&](int i) {
      const double place = 0.01 + 0.001 * std::max(0, moving - i);
      return place + (i % 2 == 0 ? 0.00011 : -0.00011);
    };
    EXPECT_GT(LookAtOneJoint(q, 200).at_rest, 200 - moving - 60) << moving;
  }
}

}  // namespace
}  // namespace robocell::internal
