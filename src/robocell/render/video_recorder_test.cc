#include "robocell/render/video_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/media/video_reader.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/step.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

constexpr char kFalling[] = R"(<mujoco><statistic extent="2"/><worldbody>
  <light pos="0 0 3"/><geom type="plane" size="2 2 .1" rgba=".5 .6 .7 1"/>
  <body name="ball" pos="0 0 1"><freejoint/><geom size=".2" rgba="1 0 0 1"/></body>
  <camera name="side" pos="0 -3 .7" xyaxes="1 0 0 0 0 1"/></worldbody></mujoco>)";

constexpr VideoRecorderOptions kSmall{.width = 64, .height = 48, .fps_num = 500, .fps_den = 33};

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

double Psnr(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum);
}

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
  VideoReader reader(folder_ / "fall.mp4");
  EXPECT_EQ(video.frames(), 6);
  std::vector<uint8_t> rgb(reader.frame_bytes());
  for (size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(reader.Next(rgb)) << i;
    EXPECT_GT(Psnr(rgb, frames[i]), 28) << i;
    if (i + 1 < frames.size()) {
      EXPECT_GT(Psnr(rgb, frames[i]), Psnr(rgb, frames[i + 1])) << i;
    }
  }
  EXPECT_FALSE(reader.Next(rgb));
}

// Where most of the ball's red is, in pixels from the top; the file is read again.
std::vector<double> RowsOfRed(const std::filesystem::path& file) {
  VideoReader reader(file);
  std::vector<uint8_t> rgb(reader.frame_bytes());
  std::vector<double> rows;
  while (reader.Next(rgb)) {
    double sum = 0, red = 0;
    for (size_t pixel = 0; pixel < rgb.size() / 3; ++pixel) {
      if (rgb[3 * pixel] < 100 || rgb[3 * pixel + 1] > 80) continue;
      sum += static_cast<double>(pixel / 64);
      ++red;
    }
    rows.push_back(red > 0 ? sum / red : NAN);
  }
  return rows;
}

TEST_F(Recording, TheTrackingCameraFollowsTheFreeOneStaysAndOneGoesBackToIt) {
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

TEST_F(Recording, NamesAreLookedUpAgainInANewModel) {
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

TEST_F(Recording, OddSizesAndUnknownCamerasAreErrorsThatTell) {
  ExpectThrow<ArgumentError>(
      [&] { VideoRecorder(model_.get(), folder_ / "odd.mp4", {.width = 63, .height = 48}); }, "63");
  VideoRecorder video(model_.get(), folder_ / "a.mp4", kSmall);
  ExpectThrow<NotFoundError>([&] { video.UseCamera("sied"); },
                             "no camera 'sied'. Its cameras: side.");
  ExpectThrow<NotFoundError>([&] { video.SetTrackingCamera("bal", 2, 90, 0); },
                             "no body 'bal'. Its bodies: world, ball. Did you mean 'ball'?");
}

TEST_F(Recording, APresetHasItsSizeAndExactlyAsManyFramesAsWereRecorded) {
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
