#include "robocell/render/video_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/step.h"
#include "robocell/render/testing/videos.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

constexpr char kFalling[] = R"(<mujoco><statistic extent="2"/><worldbody>
  <light pos="0 0 3"/><geom type="plane" size="2 2 .1" rgba=".5 .6 .7 1"/>
  <body name="ball" pos="0 0 1"><freejoint/><geom size=".2" rgba="1 0 0 1"/></body>
  <camera name="side" pos="0 -3 .7" xyaxes="1 0 0 0 0 1"/></worldbody></mujoco>)";

const VideoRecorderOptions kSmall{.width = 64, .height = 48, .fps_num = 500, .fps_den = 33};

class Recording : public testing::Test {
 protected:
  Recording() : model_(Compile(ParseXmlString(kFalling).get())), data_(MakeData(model_.get())) {}
  void SetUp() override {
    try {
      VideoRecorder(model_.get(), folder_ / "probe.mp4", kSmall);
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  TempDir folder_;
  ModelPtr model_;
  DataPtr data_;
};

TEST_F(Recording, EachCallIsOneFrameAndShowsThatState) {
  VideoRecorder video(model_.get(), folder_ / "fall.mp4", kSmall);
  video.UseCamera("side");
  const auto renderer = MakeRenderer();
  renderer->SetModel(model_.get());
  std::vector<std::vector<uint8_t>> frames;
  for (int i = 0; i < 6; ++i) {
    video.RecordFrame(data_.get());
    frames.emplace_back(3 * 64 * 48);
    renderer->Render(data_.get(), {.camera = ModelCamera{0}, .width = 64, .height = 48},
                     {.rgb = frames.back()});
    EXPECT_TRUE(Step(model_.get(), data_.get(), 40).ok());
  }
  video.Finish();
  EXPECT_EQ(video.frames(), 6);
  const std::vector<std::vector<uint8_t>> filmed = FramesOf(folder_ / "fall.mp4");
  ASSERT_EQ(filmed.size(), frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_GT(Psnr(filmed[i], frames[i]), 28) << i;
    if (i + 1 < frames.size()) {
      EXPECT_GT(Psnr(filmed[i], frames[i]), Psnr(filmed[i], frames[i + 1])) << i;
    }
  }
}

TEST_F(Recording, SwitchesBetweenTrackingAndFreeCameras) {
  VideoRecorder video(model_.get(), folder_ / "cameras.mp4", kSmall);
  const auto fall = [&](int steps) { EXPECT_TRUE(Step(model_.get(), data_.get(), steps).ok()); };
  video.SetFreeCamera(3, 90, 0, {0, 0, 0.7});
  video.RecordFrame(data_.get());
  video.SetTrackingCamera("ball", 3, 90, 0);
  video.RecordFrame(data_.get());
  fall(120);
  video.RecordFrame(data_.get());
  video.UseCamera("side");
  video.RecordFrame(data_.get());
  video.UseCamera("");  // the free camera where it was left
  video.RecordFrame(data_.get());
  video.Finish();
  const std::vector<double> rows = RowsOfRed(folder_ / "cameras.mp4");
  ASSERT_EQ(rows.size(), 5);
  EXPECT_LT(rows[0], 20) << "above the middle of the free camera";
  EXPECT_NEAR(rows[1], 23.5, 1);
  EXPECT_NEAR(rows[2], 23.5, 1) << "it fell, and the camera with it";
  EXPECT_GT(rows[4], rows[0] + 3) << "it fell";
  EXPECT_NEAR(rows[3], rows[4], 2);
}

TEST_F(Recording, ResolvesNamesAgainInANewModel) {
  VideoRecorder video(model_.get(), folder_ / "again.mp4", kSmall);
  video.SetTrackingCamera("ball", 3, 90, 0);
  video.RecordFrame(data_.get());
  const std::string before = R"(<mujoco><worldbody><light pos="0 0 3"/><body name="new"/>)";
  const ModelPtr other = Compile(
      ParseXmlString(before + R"(<body name="ball" pos="0 0 5"><geom size=".2" rgba="1 0 0 1"/>
                     </body></worldbody></mujoco>)")
          .get());
  const DataPtr there = MakeData(other.get());
  video.SetModel(other.get());
  video.RecordFrame(there.get());
  const ModelPtr without = Compile(ParseXmlString(before + "</worldbody></mujoco>").get());
  const DataPtr none = MakeData(without.get());
  ExpectThrow<NotFoundError>([&] { video.SetModel(without.get()); }, "no body 'ball'");
  ExpectThrow<NotFoundError>([&] { video.RecordFrame(none.get()); }, "no body 'ball'");
  video.UseCamera("");
  video.RecordFrame(none.get());
  video.Finish();
  const std::vector<double> rows = RowsOfRed(folder_ / "again.mp4");
  ASSERT_EQ(rows.size(), 3);
  EXPECT_NEAR(rows[0], 23.5, 1);
  EXPECT_NEAR(rows[1], 23.5, 1);
  EXPECT_TRUE(std::isnan(rows[2]));
}

TEST_F(Recording, CurrentFreeAndTrackingAreCamerasByName) {
  VideoRecorder video(model_.get(), folder_ / "named.mp4", kSmall);
  EXPECT_THAT(video.camera_names(), testing::ElementsAre("Current", "Free", "Tracking", "side"));
  const auto film = [&](const char* camera) {
    video.UseCamera(camera);
    video.RecordFrame(data_.get());
  };
  video.SetFreeCamera(3, 90, 0, {0, 0, 0.7});
  ExpectThrow<ArgumentError>([&] { video.UseCamera("Tracking"); },
                             "named.mp4': camera 'Tracking' has nothing to follow yet; "
                             "SetTrackingCamera (in Python set_tracking_camera) says which body");
  film("Current");
  video.SetTrackingCamera("ball", 3, 90, 0);
  film("Current");
  film("Free");
  film("Tracking");
  film("side");
  film("Current");
  film("");
  video.Finish();
  const std::vector<double> rows = RowsOfRed(folder_ / "named.mp4");
  ASSERT_EQ(rows.size(), 7);
  EXPECT_LT(rows[0], 20);
  for (const size_t free : {2, 6}) EXPECT_NEAR(rows[free], rows[0], 0.5) << free;
  for (const size_t tracking : {1, 3}) EXPECT_NEAR(rows[tracking], 23.5, 1) << tracking;
  EXPECT_LT(rows[4], 20);
  EXPECT_NEAR(rows[5], rows[4], 0.5);
}

TEST_F(Recording, ModelCamerasTakePrecedenceOverBuiltInNames) {
  const ModelPtr model = Compile(
      ParseXmlString(R"(<mujoco><worldbody><camera name="Free" pos="0 -3 .7" xyaxes="1 0 0 0 0 1"/>
        <light pos="0 0 3"/><geom pos="0 0 1" size=".2" rgba="1 0 0 1"/></worldbody></mujoco>)")
          .get());
  const DataPtr data = MakeData(model.get());
  VideoRecorder video(model.get(), folder_ / "own.mp4", kSmall);
  EXPECT_THAT(video.camera_names(), testing::ElementsAre("Current", "Free", "Tracking"));
  video.SetFreeCamera(3, 90, 0, {0, 0, 1});
  for (const char* camera : {"Free", ""}) {
    video.UseCamera(camera);
    video.RecordFrame(data.get());
  }
  video.Finish();
  const std::vector<double> rows = RowsOfRed(folder_ / "own.mp4");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_LT(rows[0], 20) << "the model's";
  EXPECT_NEAR(rows[1], 23.5, 1) << "the free one";
}

TEST_F(Recording, ReportsAFreedModelWithoutReadingIt) {
  ModelPtr model = Compile(ParseXmlString(kFalling).get());
  VideoRecorder video(model.get(), folder_ / "freed.mp4", kSmall);
  video.UseCamera("side");
  model.reset();
  const std::string freed =
      "the model that it was given was freed; call SetModel after a scene was built again";
  ExpectThrow<ArgumentError>([&] { video.RecordFrame(data_.get()); }, "renderer: " + freed);
  const std::string place = "freed.mp4': " + freed;
  ExpectThrow<ArgumentError>([&] { video.UseCamera("side"); }, place);
  ExpectThrow<ArgumentError>([&] { video.UseCamera(ModelCamera{0}); }, place);
  ExpectThrow<ArgumentError>([&] { video.SetFreeCamera(3, 90, 0, {0, 0, 0}); }, place);
  ExpectThrow<ArgumentError>([&] { video.SetTrackingCamera("ball", 3, 90, 0); }, place);
  ExpectThrow<ArgumentError>([&] { video.camera_names(); }, place);
  video.SetModel(model_.get());
  const double nan = std::nan("");
  ExpectThrow<ArgumentError>(
      [&] {
        video.SetFreeCamera(3, 90, 0, {0, 0, nan});
      },
      "freed.mp4': lookat[2] is nan; it must be finite");
  ExpectThrow<ArgumentError>(
      [&] {
        video.SetFreeCamera(3, HUGE_VAL, 0, {0, 0, 0});
      },
      "freed.mp4': azimuth is inf; it must be finite");
  ExpectThrow<ArgumentError>([&] { video.SetTrackingCamera("ball", -1, 90, 0); },
                             "freed.mp4': distance is -1; it must be 0 or more");
  ExpectThrow<ArgumentError>([&] { video.SetTrackingCamera("ball", nan, 90, 0); },
                             "freed.mp4': distance is nan; it must be finite");
  video.RecordFrame(data_.get());
  EXPECT_EQ(video.frames(), 1);
}

TEST_F(Recording, RejectsOddSizesAndUnknownCameras) {
  ExpectThrow<ArgumentError>(
      [&] { VideoRecorder(model_.get(), folder_ / "odd.mp4", {.width = 63, .height = 48}); }, "63");
  VideoRecorder video(model_.get(), folder_ / "a.mp4", kSmall);
  ExpectThrow<NotFoundError>(
      [&] { video.UseCamera("sied"); },
      "no camera 'sied'. Its cameras: Current, Free, Tracking, side. Did you mean "
      "'side'?");
  ExpectThrow<NotFoundError>([&] { video.SetTrackingCamera("bal", 2, 90, 0); },
                             "no body 'bal'. Its bodies: world, ball. Did you mean 'ball'?");
}

TEST_F(Recording, APresetHasItsSizeAndTheRecordedFrames) {
  const VideoSize size = SizeOf(VideoResolution::kR720p);
  const std::filesystem::path file = folder_ / "preset.mp4";
  VideoRecorder video(model_.get(), file,
                      {.width = size.width, .height = size.height, .fps_num = 60});
  for (int i = 0; i < 60; ++i) {
    video.RecordFrame(data_.get());
    EXPECT_TRUE(Step(model_.get(), data_.get(), 8).ok());
  }
  video.Finish();
  const VideoInfo info = ReadVideoInfo(file);
  EXPECT_EQ(info.width, 1280);
  EXPECT_EQ(info.height, 720);
  EXPECT_EQ(info.frames, 60);
  EXPECT_EQ(info.fps_num, 60 * info.fps_den) << "a second to the frame";
}

TEST(VideoResolutions, AreSixteenToNineAndEven) {
  EXPECT_EQ(SizeOf(VideoResolution::kR720p).width, 1280);
  for (VideoResolution r :
       {VideoResolution::kR360p, VideoResolution::kR480p, VideoResolution::kR1080p,
        VideoResolution::kR2K, VideoResolution::kR4K}) {
    EXPECT_EQ(SizeOf(r).width % 2 + SizeOf(r).height % 2, 0);
    EXPECT_NEAR(SizeOf(r).width * 9.0 / 16, SizeOf(r).height, 0.5);
  }
}

}  // namespace
}  // namespace robocell
