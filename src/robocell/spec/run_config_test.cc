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

TEST(RunConfig, AValidOnePasses) { EXPECT_EQ(ValidationError(ValidRun()), ""); }

TEST(RunConfig, NeedsNameRobotAndOutput) {
  EXPECT_EQ(ValidationError(RunConfig{}),
            "it is not valid, 3 problems:\n"
            "  run: is required: the run's name\n"
            "  output: is required: the folder the dataset goes to\n"
            "  robot: is required: a robot file, or the robot's fields");
}

TEST(RunConfig, ReportsWhatIsWrongWithTheRobotInPlace) {
  RunConfig run = ValidRun();
  run.robot.config.model = "";
  run.robot.config.reach = -1;
  EXPECT_EQ(ValidationError(run),
            "it is not valid, 2 problems:\n  robot.reach: -1 must be greater than 0\n"
            "  robot.model: is required: the robot's MJCF file");
}

TEST(RunConfig, CountsAreAboveZero) {
  RunConfig run = ValidRun();
  run.workers = 0;
  run.episodes_per_scene = -1;
  run.episodes = 0;
  EXPECT_THAT(ValidationError(run), HasSubstr("3 problems"));
}

TEST(PickTaskConfig, RangesAreSmallestFirst) {
  EXPECT_THAT(ValidationError(PickTaskConfig{.base_distance = {0.6, 0.15}}),
              HasSubstr("base_distance: [0.6, 0.15] is [smallest, largest]; the first is larger"));
  EXPECT_THAT(ValidationError(PickTaskConfig{.base_distance = {-0.1, 0.15}}),
              HasSubstr("base_distance[0]: -0.1 must not be negative"));
  EXPECT_THAT(ValidationError(PickTaskConfig{.base_height_noise = {0.1, -0.1}}),
              HasSubstr("base_height_noise: [0.1, -0.1]"));
}

TEST(SceneSource, HousesAreWholeNumbersEachOnce) {
  const auto error = [](const std::string& scenes) {
    return ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\nscenes: " +
                                 scenes);
  };
  EXPECT_EQ(error("{houses: [0..3, 7]}"), "");
  EXPECT_THAT(error("{houses: [0..3, 2]}"),
              HasSubstr("f.yaml:4:18: scenes.houses: 2 is listed twice"));
  EXPECT_THAT(error("{houses: 3..0}"), HasSubstr("rising range like 0..3, found '3..0'"));
  EXPECT_THAT(error("{houses: [-1]}"), HasSubstr("scenes.houses: -1 is negative"));
  EXPECT_THAT(error("{houses: some}"), HasSubstr("expected whole numbers"));
}

TEST(SceneSource, FilesAndSourceAgree) {
  EXPECT_EQ((SceneSource{.files = {"a.xml", "b.xml"}}.count()), 2u);
  EXPECT_EQ((SceneSource{.houses = {{1, 2, 5}}}.count()), 3u);
  EXPECT_EQ(SceneSource{}.count(), 1u);
  EXPECT_THAT(ValidationError(SceneSource{.source = SceneSourceKind::kFiles}),
              HasSubstr("files: `source: files` needs at least one MJCF file"));
  EXPECT_THAT(ValidationError(SceneSource{.source = SceneSourceKind::kTabletop, .files = {"a"}}),
              HasSubstr("files: go with `source: files`; this source is tabletop"));
  EXPECT_THAT(ValidationError(SceneSource{.houses = {{1}}, .files = {"a"}}),
              HasSubstr("houses: 1 is outside the 1 files (they count from 0)"));
}

}  // namespace
}  // namespace robocell
