#include "robocell/media/video_reader.h"

#include <gtest/gtest.h>

#include <fstream>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/media/testing/frames.h"
#include "robocell/media/testing/videos.h"
#include "robocell/media/video_writer.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

const VideoOptions kClosely{
    .width = 96, .height = 64, .fps_num = 500, .fps_den = 33, .keyframe_interval = 10};

int64_t CountFrames(const fs::path& path) {
  VideoReader video(path);
  std::vector<uint8_t> rgb(video.frame_bytes());
  int64_t count = 0;
  while (video.Next(rgb)) ++count;
  return count;
}

TEST(VideoReader, DepthRoundTripsBitwiseInOrderAndByIndex) {
  // Covers odd sizes, and the smallest.
  for (const auto& [width, height] : {std::pair(96, 64), {33, 17}, {4, 5}}) {
    TempDir folder;
    const fs::path path = folder / "a.depth.mov";
    VideoWriter writer(path, {.kind = VideoKind::kGray16,
                              .width = width,
                              .height = height,
                              .fps_num = 500,
                              .fps_den = 33});
    for (int i = 0; i < 40; ++i) writer.Write(TestDepth(width, height, i));
    writer.Finish();
    VideoReader video(path);
    EXPECT_EQ(video.info().kind, VideoKind::kGray16);
    EXPECT_EQ(video.frame_bytes(), size_t{2} * width * height);
    std::vector<uint16_t> depth(size_t{1} * width * height);
    for (int i = 0; video.Next(depth); ++i) ASSERT_EQ(depth, TestDepth(width, height, i)) << i;
    EXPECT_EQ(video.position(), 40);
    for (const int i : {39, 0, 17, 18, 3}) {
      video.Read(i, depth);
      EXPECT_EQ(depth, TestDepth(width, height, i)) << i;
    }
  }
}

TEST(VideoReader, RejectsDepthTooSmallForTheCodec) {
  TempDir folder;
  const VideoOptions options{.kind = VideoKind::kGray16, .width = 2, .height = 16};
  ExpectThrow<ArgumentError>(
      [&] { VideoWriter(folder / "a.mov", options); },
      "16-bit images of 2x16 px cannot be encoded, they need at least 4 px in both directions");
}

TEST(VideoReader, RejectsReadingAsAnotherKind) {
  TempDir folder;
  VideoWriter depth(folder / "a.mov", {.kind = VideoKind::kGray16, .width = 8, .height = 6});
  ExpectThrow<ArgumentError>([&] { depth.Write(std::vector<uint8_t>(96)); },
                             "expected a 16-bit frame of 6x8x2 = 96 bytes, got 96 of colour");
  depth.Write(TestDepth(8, 6, 0));
  depth.Finish();
  VideoReader reader(folder / "a.mov");
  std::vector<uint8_t> bytes(96);
  ExpectThrow<ArgumentError>([&] { reader.Next(bytes); },
                             "expected a buffer of 6x8x2 = 96 bytes as uint16, got 96");
  VideoWriter colour(folder / "b.mp4", {.width = 8, .height = 6});
  ExpectThrow<ArgumentError>([&] { colour.Write(std::vector<uint16_t>(72)); },
                             "expected a colour frame of 6x8x3 = 144 bytes, got 144 of 16-bit");
}

TEST(VideoReader, DepthHasTheSameBytesEveryTime) {
  TempDir folder;
  for (const char* name : {"a.mov", "b.mov"}) {
    VideoWriter writer(folder / name, {.kind = VideoKind::kGray16, .width = 96, .height = 64});
    for (int i = 0; i < 12; ++i) writer.Write(TestDepth(96, 64, i));
    writer.Finish();
  }
  EXPECT_EQ(ReadFile(folder / "a.mov"), ReadFile(folder / "b.mov"));
}

TEST(VideoReader, AFrameReadByIndexIsTheFrameReadInOrder) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 95, kClosely);
  VideoReader in_order(folder / "a.mp4");
  std::vector<std::vector<uint8_t>> frames(95, std::vector<uint8_t>(in_order.frame_bytes()));
  for (auto& frame : frames) ASSERT_TRUE(in_order.Next(frame));
  VideoReader by_index(folder / "a.mp4");
  std::vector<uint8_t> rgb(by_index.frame_bytes());
  for (const int index : {94, 0, 1, 9, 10, 11, 80, 3, 3, 29, 30, 93}) {
    by_index.Read(index, rgb);
    EXPECT_EQ(rgb, frames[index]) << "frame " << index;
    EXPECT_EQ(by_index.position(), index + 1);
  }
  EXPECT_TRUE(by_index.Next(rgb));
  EXPECT_EQ(rgb, frames[94]);
  EXPECT_FALSE(by_index.Next(rgb));
}

TEST(VideoReader, SeekingIsExactAtAwkwardRates) {
  TempDir folder;
  for (const auto& [num, den] : {std::pair{30000, 1001}, {1, 3}, {997, 1}, {500, 33}}) {
    VideoOptions options = kClosely;
    options.fps_num = num;
    options.fps_den = den;
    WriteVideo(folder / "a.mp4", 25, options);
    VideoReader video(folder / "a.mp4");
    std::vector<uint8_t> rgb(video.frame_bytes());
    video.Read(23, rgb);
    EXPECT_GT(Psnr(rgb, TestFrame(96, 64, 23)), 3 + Psnr(rgb, TestFrame(96, 64, 22)))
        << num << "/" << den;
    EXPECT_GT(Psnr(rgb, TestFrame(96, 64, 23)), 3 + Psnr(rgb, TestFrame(96, 64, 24)))
        << num << "/" << den;
  }
}

TEST(VideoReader, ExplainsInvalidRequests) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 5, kClosely);
  VideoReader video(folder / "a.mp4");
  std::vector<uint8_t> rgb(video.frame_bytes());
  ExpectThrow<ArgumentError>([&] { video.Read(5, rgb); }, "no frame 5. It has frames 0 ... 4");
  std::vector<uint8_t> small(7);
  ExpectThrow<ArgumentError>([&] { video.Next(small); },
                             "expected a buffer of 64x96x3 = 18432 bytes, got 7");
  ExpectThrow<IoError>([&] { VideoReader(folder / "b.mp4"); }, "b.mp4': No such file or directory");
}

TEST(VideoReader, AVideoCutAnywhereIsAnErrorNotAShorterVideo) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 30, kClosely);
  const std::string whole = ReadFile(folder / "a.mp4");
  for (int percent = 0; percent < 100; percent += 7) {
    Store(folder / "cut.mp4", whole.substr(0, whole.size() * percent / 100));
    ExpectThrow<IoError>([&] { CountFrames(folder / "cut.mp4"); }, "cut.mp4");
  }
}

TEST(VideoReader, AFlippedByteNeverChangesTheNumberOfFramesSilently) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 12, kClosely);
  const std::string whole = ReadFile(folder / "a.mp4");
  int found = 0;
  for (int part = 0; part < 25; ++part) {
    std::string damaged = whole;
    damaged[whole.size() * part / 25] ^= 0x55;
    Store(folder / "damaged.mp4", damaged);
    try {
      EXPECT_EQ(CountFrames(folder / "damaged.mp4"), 12);
    } catch (const IoError&) {
      ++found;
    }
  }
  EXPECT_GT(found, 5);
}

}  // namespace
}  // namespace robocell
