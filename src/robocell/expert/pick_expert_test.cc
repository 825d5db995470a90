#include "robocell/expert/pick_expert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// Returns the problem reported for ranges and a lift, for the robot of the demo, whose reach is
// about 0.8 m.
std::string ReachProblem(const BaseRange& base, double lift_height = 0.05) {
  static const PickScene kScene = MakePickScene(ObjectOnTheTable("box"));
  Problems problems;
  ValidateReach({.objects = {}, .lift_height = lift_height}, base, kScene.robot, problems);
  if (problems.empty()) return "";
  EXPECT_EQ(problems.list().size(), 1u);
  return problems.list()[0].path + ": " + problems.list()[0].message;
}

TEST(ValidateReach, RangesWithinTheReachPass) {
  EXPECT_EQ(ReachProblem({.distance = {0.3, 0.5}, .height_offset = -0.25}), "");
}

TEST(ValidateReach, ReportsTheMaximumForADistanceBeyondTheReach) {
  EXPECT_THAT(ReachProblem({.distance = {0.3, 5}}),
              HasSubstr("start.base_distance: [0.3, 5] m goes beyond "));
}

TEST(ValidateReach, ReportsAHeightBeyondTheReach) {
  EXPECT_THAT(ReachProblem({.height_offset = 7}),
              HasSubstr("start.base_height_offset: 7 m puts the base frame "));
  // The noise may bring the height back into reach.
  EXPECT_EQ(ReachProblem({.distance = {0.1, 0.2}, .height_offset = 2, .height_noise = {-2, 0}}),
            "");
}

TEST(ValidateReach, RejectsAnImpossibleLift) {
  EXPECT_THAT(ReachProblem({.distance = {0.3, 0.5}, .height_offset = -0.25}, 3),
              HasSubstr("task.lift_height: 3 m is more than the arm can lift"));
}

}  // namespace
}  // namespace robocell::internal
