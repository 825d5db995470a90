// Tests which arms do the task of a run.
#include "robocell/task/run_arms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/task/pick_task_config.h"
#include "robocell/task/testing/two_hands.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

class RunArmsTest : public TwoHandsTest {
 protected:
  RunConfig Run(const std::string& arm) const {
    RunConfig run;
    run.robot.config = scene_->compiled()->robot("hands").config;
    run.task = PickTaskConfig{.arm = arm};
    return run;
  }
};

TEST_F(RunArmsTest, AreAllWithHandsUnlessOneIsNamed) {
  for (const char* any : {"", "any"}) {
    EXPECT_THAT(internal::ArmsOfRun(Run(any), *scene_), ElementsAre("hands/left", "hands/right"));
    EXPECT_EQ(internal::FirstArmOfRun(Run(any)), "hands");
  }
  EXPECT_THAT(internal::ArmsOfRun(Run("right"), *scene_), ElementsAre("hands/right"));
  EXPECT_EQ(internal::FirstArmOfRun(Run("right")), "hands/right");
}

}  // namespace
}  // namespace robocell
