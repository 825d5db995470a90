#include "robocell/spec/start_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ValidationError;

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

}  // namespace
}  // namespace robocell
