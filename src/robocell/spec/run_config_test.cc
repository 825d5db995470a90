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

TEST(Rates, AreMultiplesOfEachOther) {
  EXPECT_EQ((Rates{.policy_ms = 66, .control_ms = 2, .sim_ms = 1}.control_ticks()), 33);
  EXPECT_EQ((Rates{.policy_ms = 66, .control_ms = 2, .sim_ms = 1}.sim_steps()), 2);
  EXPECT_EQ((Rates{.policy_ms = 0.3, .control_ms = 0.1, .sim_ms = 0.1}.control_ticks()), 3);
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 65}),
            "it is not valid: policy_ms: 65 ms is not a multiple of control_ms (2 ms); the nearest "
            "are 64 and 66 ms");
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 0.066}),
            "it is not valid: policy_ms: 0.066 ms is not a multiple of control_ms (2 ms); the "
            "nearest are 2 and 4 ms. Are these seconds? Then write 66");
  EXPECT_THAT(ValidationError(Rates{.policy_ms = 1, .control_ms = 2}), Not(HasSubstr("seconds")));
  EXPECT_THAT(ValidationError(Rates{.policy_ms = 1, .control_ms = 2}),
              HasSubstr("policy_ms: 1 ms is not a multiple of control_ms (2 ms)"));
  EXPECT_THAT(ValidationError(Rates{.sim_ms = 0}), HasSubstr("sim_ms: 0 must be greater than 0"));
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 1000, .control_ms = 500, .sim_ms = 500}),
            "it is not valid: sim_ms: 500 ms is too long for a step of the engine, at most 100 ms; "
            "2 ms is usual");
}

TEST(Rates, AreNeverSoShortOrSoLongThatARunDoesNotEnd) {
  EXPECT_EQ(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                  "rates: {policy_ms: 66, control_ms: 2, sim_ms: 0.002}"),
            "f.yaml is not valid: f.yaml:4:47: rates.sim_ms: 0.002 ms is too short for a step of "
            "the engine, at least "
            "0.01 ms; 2 ms is usual");
  EXPECT_EQ(ValidationError(Rates{.sim_ms = 0.01}), "");
  EXPECT_EQ(ValidationError(Rates{.policy_ms = 66e6}),
            "it is not valid: policy_ms: 6.6e+07 ms are 33000000 steps of the engine of 2 ms for "
            "every action, at most 1000000; 66 ms is usual");
}

TEST(TaskConfig, RangesAreSmallestFirst) {
  EXPECT_THAT(ValidationError(TaskConfig{.base_distance = {0.6, 0.15}}),
              HasSubstr("base_distance: [0.6, 0.15] is [smallest, largest]; the first is larger"));
  EXPECT_THAT(ValidationError(TaskConfig{.base_distance = {-0.1, 0.15}}),
              HasSubstr("base_distance[0]: -0.1 must not be negative"));
  EXPECT_THAT(ValidationError(TaskConfig{.base_height_noise = {0.1, -0.1}}),
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
