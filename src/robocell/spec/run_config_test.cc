#include "robocell/spec/run_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using testing::ValidationError;

RunConfig ValidRun() {
  return {.run = "r", .robot = {.config = {.name = "a", .model = "a.xml"}}, .output = "out"};
}

TEST(RunConfig, AcceptsAValidConfiguration) { EXPECT_EQ(ValidationError(ValidRun()), ""); }

TEST(RunConfig, NeedsNameRobotAndOutput) {
  EXPECT_EQ(ValidationError(RunConfig{}),
            "it is not valid, 3 problems:\n"
            "  run: is required: the run's name\n"
            "  output: is required: the folder the dataset goes to\n"
            "  robot: is required: a robot file, or the robot's fields");
}

TEST(RunConfig, ReportsErrorsOfTheInlineRobot) {
  RunConfig run = ValidRun();
  run.robot.config.model = "";
  run.robot.config.reach = -1;
  EXPECT_EQ(ValidationError(run),
            "it is not valid, 2 problems:\n  robot.reach: -1 must be greater than 0\n"
            "  robot.model: is required: the robot's MJCF file");
}

TEST(RunConfig, CountsMustBePositive) {
  RunConfig run = ValidRun();
  run.workers = 0;
  run.episodes_per_scene = -1;
  run.episodes = 0;
  EXPECT_THAT(ValidationError(run), HasSubstr("3 problems"));
}

TEST(ImportsOfRunFile, AreEmptyForAMissingFile) {
  EXPECT_THAT(ImportsOfRunFile("."), ::testing::IsEmpty());
  EXPECT_THAT(ImportsOfRunFile("nowhere.yaml"), ::testing::IsEmpty());
}

}  // namespace
}  // namespace robocell
