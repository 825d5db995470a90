#include "robocell/spec/start_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

TEST(StartConfig, RangesMustIncrease) {
  EXPECT_THAT(ValidationError(StartConfig{.base_distance = {{0.6, 0.15}}}),
              HasSubstr("base_distance: [0.6, 0.15] is [smallest, largest]; the first is larger"));
  EXPECT_THAT(ValidationError(StartConfig{.base_distance = {{-0.1, 0.15}}}),
              HasSubstr("base_distance[0]: -0.1 must not be negative"));
  EXPECT_THAT(ValidationError(StartConfig{.base_height_noise = {{0.1, -0.1}}}),
              HasSubstr("base_height_noise: [0.1, -0.1]"));
}

TEST(StartConfig, PointsAMovedFieldToItsNewPlace) {
  EXPECT_THAT(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                    "task: {kind: pick, base_distance: [0.3, 0.6]}"),
              HasSubstr("f.yaml:4:20: task.base_distance: a PickTaskConfig: no field "
                        "'base_distance'"));
  EXPECT_THAT(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                    "task: {kind: pick, base_distance: [0.3, 0.6]}"),
              HasSubstr("It is a field of `start` of a run, for all tasks: start.base_distance"));
}

TEST(StartConfig, SuggestsTheNearestField) {
  EXPECT_THAT(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                    "start: {base_distanc: [0.3, 0.6]}"),
              HasSubstr("Did you mean 'base_distance'?"));
}

}  // namespace
}  // namespace robocell
