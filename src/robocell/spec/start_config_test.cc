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

TEST(StartCamera, IsInOnePlace) {
  EXPECT_EQ(ValidationError(StartCamera{.camera = "wrist"}), "");
  EXPECT_EQ(ValidationError(StartCamera{.around = {"target"}}), "");
  EXPECT_THAT(ValidationError(StartCamera{.camera = "wrist", .around = {"target"}}),
              HasSubstr("around: is set together with a camera, a mount or a pose"));
  EXPECT_THAT(ValidationError(StartCamera{.camera = "wrist", .mount = "link7", .pos = Vec3{}}),
              HasSubstr("camera: is set together with a mount or a pose"));
  EXPECT_THAT(ValidationError(StartCamera{.mount = "link7"}),
              HasSubstr("pos: is required with a mount"));
  EXPECT_THAT(ValidationError(StartCamera{.pos = Vec3{1, 0, 0}, .look_at = Vec3{1, 0, 0}}),
              HasSubstr("look_at: is the camera's own position"));
  EXPECT_THAT(ValidationError(StartCamera{.pos = Vec3{1, 0, 0}, .fovy = 5, .fovy_noise = 6}),
              HasSubstr("fovy_noise: 6 degrees around 5 leave the range"));
  EXPECT_THAT(ValidationError(StartCamera{.around = {"target"}, .distance = {1, 0.5}}),
              HasSubstr("distance: [1, 0.5] is [smallest, largest]"));
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
