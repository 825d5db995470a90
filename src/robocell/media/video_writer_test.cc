#include "robocell/media/video_writer.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/temporary_name.h"
#include "robocell/media/testing/fake_ffmpeg.h"
#include "robocell/media/testing/frames.h"
#include "robocell/media/testing/videos.h"
#include "robocell/media/video_reader.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const VideoOptions kSmall{.width = 96, .height = 64, .fps_num = 500, .fps_den = 33};

// Expects an empty folder, also without hidden files.
void ExpectEmpty(const TempDir& folder) { EXPECT_TRUE(fs::is_empty(folder.path())); }

TEST(VideoWriter, FramesRoundTripInNumberRateAndContent) {
  TempDir folder;
  const VideoOptions options{.width = 320, .height = 240, .fps_num = 500, .fps_den = 33};
  WriteVideo(folder / "a.mp4", 40, options);
  VideoReader video(folder / "a.mp4");
  EXPECT_EQ(video.info().frames, 40);
  EXPECT_EQ(video.info().fps_num, 500);
  EXPECT_EQ(video.info().fps_den, 33);
  EXPECT_THAT(video.info().encoder, StartsWith("x264 - core "));
  std::vector<uint8_t> rgb(video.frame_bytes());
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(video.Next(rgb));
    const double own = Psnr(rgb, TestFrame(320, 240, i));
    EXPECT_GE(own, 35) << "frame " << i;
    EXPECT_GT(own, 3 + Psnr(rgb, TestFrame(320, 240, i + 1))) << "frame " << i;
  }
  EXPECT_FALSE(video.Next(rgb));
}

TEST(VideoWriter, PresetForRenderedImagesKeepsTheirQualityAndNearlyTheirSize) {
  TempDir folder;
  double quality[2] = {}, size[2] = {};
  const char* const presets[] = {"superfast", "rendered"};
  constexpr int kFrames = 20;
  for (int i = 0; i < 2; ++i) {
    const fs::path file = folder / (std::string(presets[i]) + ".mp4");
    WriteVideo(file, kFrames, {.width = 160, .height = 120, .preset = presets[i]});
    size[i] = static_cast<double>(fs::file_size(file));
    VideoReader video(file);
    std::vector<uint8_t> rgb(video.frame_bytes());
    for (int frame = 0; frame < kFrames; ++frame) {
      ASSERT_TRUE(video.Next(rgb));
      quality[i] += Psnr(rgb, TestFrame(160, 120, frame)) / kFrames;
    }
  }
  EXPECT_GT(quality[1], quality[0] - 0.2) << "dB";
  EXPECT_LT(size[1], 1.1 * size[0]) << "bytes";
}

TEST(VideoWriter, GrayStaysGrayAndColoursHaveNoBias) {
  TempDir folder;
  std::vector<uint8_t> flat;
  for (int i = 0; i < 96 * 64; ++i) flat.insert(flat.end(), {200, 100, 50});
  {
    VideoWriter video(folder / "a.mp4", kSmall);
    for (int i = 0; i < 5; ++i) video.Write(flat);
    video.Finish();
  }
  VideoReader video(folder / "a.mp4");
  std::vector<uint8_t> rgb(video.frame_bytes());
  video.Read(4, rgb);
  for (size_t i = 0; i < rgb.size(); ++i) EXPECT_NEAR(rgb[i], flat[i], 2) << "value " << i;
}

TEST(VideoWriter, SameFramesGiveSameBytesInAnyProcess) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 50, kSmall);
  {
    std::thread load([&] { WriteVideo(folder / "load.mp4", 50, kSmall); });
    WriteVideo(folder / "b.mp4", 50, kSmall);
    load.join();
  }
  EXPECT_EQ(InOwnProcess([&] {
              WriteVideo(folder / "c.mp4", 50, kSmall);
              return 0;
            }),
            0);
  EXPECT_EQ(ReadFile(folder / "a.mp4"), ReadFile(folder / "b.mp4"));
  EXPECT_EQ(ReadFile(folder / "a.mp4"), ReadFile(folder / "load.mp4"));
  EXPECT_EQ(ReadFile(folder / "a.mp4"), ReadFile(folder / "c.mp4"));
}

TEST(VideoWriter, RejectsAnOddSizeAndSuggestsTheNearestEvenOne) {
  TempDir folder;
  ExpectThrow<ArgumentError>(
      [&] { VideoWriter(folder / "a.mp4", {.width = 321, .height = 241}); },
      "321x241 px cannot be encoded, h264 with yuv420p needs an even width and height. "
      "Nearest even size: 322x242.");
  ExpectEmpty(folder);
}

TEST(VideoWriter, RejectsOtherFileExtensions) {
  TempDir folder;
  ExpectThrow<ArgumentError>(
      [&] { VideoWriter(folder / "a.xyz", kSmall); },
      "a.xyz': colour videos are mp4 files; name it '" + (folder / "a.mp4").string() + "'");
  VideoOptions depth = kSmall;
  depth.kind = VideoKind::kGray16;
  ExpectThrow<ArgumentError>([&] { VideoWriter(folder / "a.mp4", depth); },
                             "16-bit videos are mov files");
  ExpectEmpty(folder);
}

TEST(VideoWriter, RejectsInvalidOptionsByName) {
  TempDir folder;
  const fs::path path = folder / "a.mp4";
  ExpectThrow<ArgumentError>([&] { VideoWriter(path, {.width = 0, .height = 10}); },
                             "size 0x10 px is not between");
  ExpectThrow<ArgumentError>([&] { VideoWriter(path, {.width = 8, .height = 8, .fps_num = 0}); },
                             "rate 0/1 frames per second is not positive");
  ExpectThrow<ArgumentError>(
      [&] { VideoWriter(path, {.width = 8, .height = 8, .preset = "supafast"}); },
      "Did you mean 'superfast'?");
  ExpectThrow<ArgumentError>([&] { VideoWriter(path, {.width = 8, .height = 8, .crf = 60}); },
                             "crf 60 is not in 0");
}

TEST(VideoWriter, RejectsAFrameOfTheWrongSizeAndContinues) {
  TempDir folder;
  VideoWriter video(folder / "a.mp4", kSmall);
  ExpectThrow<ArgumentError>([&] { video.Write(std::vector<uint8_t>(10)); },
                             "expected a colour frame of 64x96x3 = 18432 bytes, got 10");
  video.Write(TestFrame(96, 64, 0));
  video.Finish();
  EXPECT_EQ(ReadVideoInfo(folder / "a.mp4").frames, 1);
  ExpectThrow<ClosedError>([&] { video.Write(TestFrame(96, 64, 0)); },
                           "it is finished, so it cannot be written to; begin another video");
}

TEST(VideoWriter, AVideoWithoutFramesIsNotWritten) {
  TempDir folder;
  {
    VideoWriter video(folder / "a.mp4", kSmall);
    ExpectThrow<ArgumentError>([&] { video.Finish(); }, "no frame was written");
  }
  ExpectEmpty(folder);
}

TEST(VideoWriter, AMissingFolderIsNamed) {
  TempDir folder;
  ExpectThrow<IoError>([&] { VideoWriter(folder / "no" / "a.mp4", kSmall); },
                       "No such file or directory");
}

TEST(VideoWriter, WithoutFinishLeavesNoFileAndNoZombie) {
  TempDir folder;
  {
    VideoWriter video(folder / "a.mp4", kSmall);
    video.Write(TestFrame(96, 64, 0));
  }
  ExpectEmpty(folder);
  ExpectNoChildLeft();
}

// Leftovers of a killed process are found and removed by their name.
TEST(VideoWriter, WhileItIsWrittenItHasATemporaryName) {
  TempDir folder;
  const VideoWriter video(folder / "a.mp4", kSmall);
  const auto name = internal::TemporaryName::Parse(
      fs::directory_iterator(folder.path())->path().filename().string());
  ASSERT_TRUE(name);
  EXPECT_EQ(name->name, "a.mp4");
  EXPECT_EQ(name->process, getpid());
}

TEST(VideoWriter, ADeadEncoderIsAnErrorAndLeavesNothing) {
  signal(SIGPIPE, SIG_DFL);
  TempDir folder;
  {
    VideoWriter video(folder / "a.mp4", {.width = 320, .height = 240});
    video.Write(TestFrame(320, 240, 0));
    kill(video.encoder_pid(), SIGKILL);
    const std::string message = ExpectThrow<EncoderDied>(
        [&] {
          for (int i = 0; i < 100; ++i) video.Write(TestFrame(320, 240, i));
        },
        "the encoder was killed by signal 9 (Killed) after");
    EXPECT_THAT(message, HasSubstr("a.mp4"));
    EXPECT_EQ(ExpectThrow<IoError>([&] { video.Finish(); }, "killed by signal 9"), message);
  }
  ExpectEmpty(folder);
  ExpectNoChildLeft();
}

TEST(VideoWriter, AnEncoderKilledBeforeFinishIsAnError) {
  TempDir folder;
  VideoWriter video(folder / "a.mp4", kSmall);
  video.Write(TestFrame(96, 64, 0));
  kill(video.encoder_pid(), SIGKILL);
  ExpectThrow<EncoderDied>([&] { video.Finish(); }, "killed by signal 9");
  EXPECT_FALSE(fs::exists(folder / "a.mp4"));
}

TEST(VideoWriter, AStoppedEncoderHitsTheDeadline) {
  TempDir folder;
  VideoOptions options = kSmall;
  options.stall_timeout_s = 0.2;
  VideoWriter video(folder / "a.mp4", options);
  kill(video.encoder_pid(), SIGSTOP);
  ExpectThrow<IoError>(
      [&] {
        for (int i = 0; i < 1000; ++i) video.Write(TestFrame(96, 64, i));
      },
      "made no progress for 0.2 s");
  ExpectNoChildLeft();
}

TEST(VideoWriter, QuotesTheErrorOutputOfTheEncoder) {
  TempDir folder;
  FakeFfmpeg fake("cat > /dev/null; echo 'Unknown encoder libx264' >&2; exit 1");
  VideoWriter video(folder / "a.mp4", kSmall);
  video.Write(TestFrame(96, 64, 0));
  ExpectThrow<IoError>([&] { video.Finish(); },
                       "exited with code 1 after 1 frame; it said 'Unknown encoder libx264'");
}

TEST(VideoWriter, DetectsAnEncoderThatWritesNothing) {
  TempDir folder;
  FakeFfmpeg fake("cat > /dev/null");
  VideoWriter video(folder / "a.mp4", kSmall);
  video.Write(TestFrame(96, 64, 0));
  ExpectThrow<IoError>([&] { video.Finish(); }, "is not a readable mp4: it is empty");
  EXPECT_FALSE(fs::exists(folder / "a.mp4"));
}

// Simulates a disk that is full after `bytes`; SIGXFSZ ends ffmpeg, which inherits the limit.
int WriteWithSpace(const fs::path& path, rlim_t bytes) {
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
  try {
    WriteVideo(path, 60, kSmall);
    return 0;
  } catch (const IoError&) {
    return fs::exists(path) ? 2 : 1;
  }
}

TEST(VideoWriter, AFullDiskIsAnErrorAtEveryPoint) {
  TempDir folder;
  WriteVideo(folder / "whole.mp4", 60, kSmall);
  const auto size = fs::file_size(folder / "whole.mp4");
  for (int i = 0; i < 5; ++i) {
    const rlim_t space = i * size / 5;
    EXPECT_EQ(InOwnProcess([&] { return WriteWithSpace(folder / "a.mp4", space); }), 1)
        << space << " bytes";
  }
  EXPECT_EQ(InOwnProcess([&] { return WriteWithSpace(folder / "a.mp4", size + 100000); }), 0);
}

TEST(VideoWriter, HostileFileNamesAreHarmless) {
  TempDir folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  for (const std::string name :
       {"-y.mp4", "$(touch injected) ' \".mp4", "concat:a|b.mp4", "ü %03d.mp4"}) {
    WriteVideo(name, 3, kSmall);
    EXPECT_EQ(ReadVideoInfo(folder / name).frames, 3) << name;
    VideoReader video(folder / name);
    std::vector<uint8_t> rgb(video.frame_bytes());
    EXPECT_TRUE(video.Next(rgb)) << name;
  }
  fs::current_path(before);
  EXPECT_FALSE(fs::exists(folder / "injected"));
}

TEST(VideoWriter, ManyVideosLeaveNoDescriptorsOpen) {
  TempDir folder;
  auto open_descriptors = [] {
    return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
  };
  WriteVideo(folder / "a.mp4", 2, kSmall);
  const auto before = open_descriptors();
  for (int i = 0; i < 5; ++i) WriteVideo(folder / "a.mp4", 2, kSmall);
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace robocell
