#include "robocell/spec/camera_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

TEST(CameraSpec, NeedsNamePlaceAndLens) {
  EXPECT_EQ(ValidationError(CameraSpec{}),
            "it is not valid, 3 problems:\n"
            "  name: is required: cameras are looked up by name\n"
            "  pos: is required: where the camera is, [x, y, z] in metres\n"
            "  fovy: is required: the vertical field of view in degrees, for example 45");
  EXPECT_THAT(ValidationError(CameraSpec{.name = "a", .pos = Vec3{}, .fovy = 180}),
              HasSubstr("fovy: 180 degrees is not below 180"));
}

TEST(CameraSpec, LooksAtItsTargetWithZUp) {
  const CameraSpec camera{.name = "a", .pos = Vec3{1, 2, 3}, .fovy = 45, .look_at = Vec3{-1, 0, 1}};
  const Eigen::Matrix3d r = camera.pose().rotation();
  const Eigen::Vector3d towards = Eigen::Vector3d(-2, -2, -2).normalized();
  EXPECT_TRUE((-r.col(2)).isApprox(towards, 1e-12));  // looks along -z
  EXPECT_NEAR(r(2, 0), 0, 1e-12);                     // the image's x axis is level
  EXPECT_GT(r(2, 1), 0);                              // and its y axis points up
}

TEST(CameraSpec, LooksStraightDownAndUp) {
  for (const double z : {0.0, 6.0}) {
    const CameraSpec camera{
        .name = "a", .pos = Vec3{0, 0, 3}, .fovy = 45, .look_at = Vec3{0, 0, z}};
    EXPECT_EQ(ValidationError(camera), "");
    const Eigen::Matrix3d r = camera.pose().rotation();
    EXPECT_TRUE((-r.col(2)).isApprox(Eigen::Vector3d(0, 0, z - 3).normalized(), 1e-12));
    EXPECT_TRUE(r.col(0).isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  }
}

TEST(CameraSpec, LookAtExcludesARotation) {
  CameraSpec camera{.name = "a", .pos = Vec3{}, .fovy = 45, .look_at = Vec3{}};
  const std::string nowhere =
      "look_at: is the camera's own position, so there is nowhere to look; give a point in front "
      "of "
      "the camera, or `euler` or `quat`";
  EXPECT_THAT(ValidationError(camera), HasSubstr(nowhere));
  camera.look_at = Vec3{0, 1e-200, 0};  // its square is 0
  EXPECT_THAT(ValidationError(camera), HasSubstr(nowhere));
  camera.look_at = Vec3{1, 0, 0};
  camera.euler = {0, 0, 90};
  EXPECT_THAT(ValidationError(camera), HasSubstr("look_at: is set together with a rotation"));
}

TEST(CameraSystemConfig, RejectsOddSizes) {
  EXPECT_EQ(
      ParseError<CameraSystemConfig>(
          "resolution: [623, 351]\nstreams: [{name: wrist, camera: wrist_camera}]\n"),
      "f.yaml is not valid: f.yaml:2:11: stream 'wrist' (streams[0]): size 623x351 cannot be "
      "encoded as video, "
      "which needs even numbers (of environments too: a dataset can have the same cameras); the "
      "nearest size is 624x352; correct the stream's width and "
      "height, or "
      "`cameras.resolution`");
}

TEST(CameraSystemConfig, ReportsSizesBelowOnePixelOnce) {
  CameraSystemConfig cameras{.streams = {{.name = "a", .camera = "a", .width = -3}}};
  const std::string text = ValidationError(cameras);
  EXPECT_THAT(text, HasSubstr("width: -3 must be greater than 0"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("nearest")));
  cameras = {.resolution = {0, -2}};
  EXPECT_THAT(ValidationError(cameras),
              HasSubstr("resolution: 0 x -2 pixels are not an image; both must be above 0"));
}

TEST(CameraSystemConfig, RejectsSizesTooLargeForVideos) {
  CameraSystemConfig cameras{.resolution = {100000, 100000},
                             .streams = {{.name = "a", .camera = "a"}}};
  EXPECT_THAT(
      ValidationError(cameras),
      HasSubstr(
          "stream 'a' (streams[0]): size 100000x100000 is too large: width and height can be at "
          "most 16384 pixels; correct the stream's width and height, or "
          "`cameras.resolution`"));
  cameras.resolution = {16384, 16384};
  EXPECT_EQ(ValidationError(cameras), "");
}

TEST(CameraSystemConfig, ValidatesTheSizeOfAStream) {
  CameraSystemConfig cameras{.streams = {{.name = "a", .camera = "a", .height = 241}}};
  EXPECT_THAT(ValidationError(cameras), HasSubstr("size 320x241 cannot"));
  cameras.streams[0].rgb = false;
  cameras.streams[0].depth = true;
  EXPECT_EQ(ValidationError(cameras), "");
}

TEST(CameraSystemConfig, RequiresUniqueStreamNames) {
  const CameraSystemConfig cameras{
      .streams = {{.name = "a", .camera = "x"}, {.name = "a", .camera = "y"}, {.camera = "z"}}};
  EXPECT_EQ(ValidationError(cameras),
            "it is not valid, 2 problems:\n"
            "  stream 'a' (streams[1]).name: 'a' is used twice\n"
            "  streams[2].name: is required: streams are recorded under their name");
}

TEST(CameraConfig, RequiresAtLeastOneKindOfImage) {
  EXPECT_THAT(ValidationError(CameraConfig{.name = "a", .camera = "b", .rgb = false}),
              HasSubstr("takes no images: set rgb, depth or segmentation"));
}

}  // namespace
}  // namespace robocell
