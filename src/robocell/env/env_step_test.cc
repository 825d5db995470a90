#include "robocell/env/env_step.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace robocell {
namespace {

TEST(EnvSteps, EachReasonHasItsName) {
  std::set<std::string> names;
  for (const EndReason reason : {EndReason::kDiverged, EndReason::kCollision, EndReason::kIkFailed,
                                 EndReason::kArrived, EndReason::kSettled, EndReason::kTimeout})
    names.insert(ToString(reason));
  EXPECT_EQ(names, (std::set<std::string>{"arrived", "collision", "diverged", "ik_failed",
                                          "settled", "timeout"}));
}

TEST(EnvSteps, ACollisionNamesTheBodiesAndTheirRobots) {
  EXPECT_EQ(
      Describe({.robot = "left", .body = "left_hand", .other_robot = "", .other_body = "cup"}),
      "robot 'left' (left_hand) touches cup");
  EXPECT_EQ(Describe({.robot = "left",
                      .body = "left_hand",
                      .other_robot = "right",
                      .other_body = "right_link5"}),
            "robot 'left' (left_hand) touches robot 'right' (right_link5)");
}

TEST(EnvSteps, AStepIsTheVerdictOfItsTask) {
  EnvStep step;
  EXPECT_FALSE(step.success);
  static_cast<TaskVerdict&>(step) = {.reward = 0.5, .success = true, .progress = 1, .subtask = 2};
  EXPECT_EQ(step.reward, 0.5);
  EXPECT_TRUE(step.success);
  EXPECT_EQ(step.subtask, 2);
}

}  // namespace
}  // namespace robocell
