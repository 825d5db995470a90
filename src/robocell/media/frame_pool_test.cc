#include "robocell/media/frame_pool.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/media/testing/videos.h"
#include "robocell/media/video_reader.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

const VideoOptions kPooled{.width = 32, .height = 16, .keyframe_interval = 10};
using Rgb = std::vector<uint8_t>;

std::vector<Rgb> AllFrames(const fs::path& path) {
  VideoReader video(path);
  std::vector<Rgb> all;
  Rgb rgb(video.frame_bytes());
  while (video.Next(rgb)) all.push_back(rgb);
  return all;
}

Rgb FrameOf(FramePool& pool, const fs::path& path, int64_t index) {
  Rgb rgb(size_t{3} * kPooled.width * kPooled.height);
  pool.Read(path, index, rgb);
  return rgb;
}

// Replaces ffmpeg during its lifetime, and counts how often it is started.
class CountedFfmpeg {
 public:
  explicit CountedFfmpeg(const fs::path& folder) : log_(folder / "starts") {
    const fs::path program = folder / "counted_ffmpeg";
    std::ofstream(program) << "#!/bin/sh\necho >> '" << log_.string() << "'\nexec '" << FindFfmpeg()
                           << "' \"$@\"\n";
    fs::permissions(program, fs::perms::owner_all);
    setenv("ROBOCELL_FFMPEG", program.c_str(), 1);
  }
  ~CountedFfmpeg() { unsetenv("ROBOCELL_FFMPEG"); }
  CountedFfmpeg(const CountedFfmpeg&) = delete;
  CountedFfmpeg& operator=(const CountedFfmpeg&) = delete;
  int64_t starts() const {
    std::error_code none;
    const auto size = fs::file_size(log_, none);
    return none ? 0 : static_cast<int64_t>(size);
  }

 private:
  fs::path log_;
};

TEST(FramePool, FramesInOrderStartOneDecoder) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 40, kPooled);
  const std::vector<Rgb> all = AllFrames(folder / "a.mp4");
  const CountedFfmpeg ffmpeg(folder.path());
  FramePool pool;
  for (int i = 0; i < 40; ++i) ASSERT_EQ(FrameOf(pool, folder / "a.mp4", i), all[i]) << i;
  EXPECT_EQ(ffmpeg.starts(), 1);
  // A window that slides forward reads earlier frames again.
  for (int i = 2; i < 39; ++i) {
    for (int k = i - 2; k <= i; ++k) ASSERT_EQ(FrameOf(pool, folder / "a.mp4", k), all[k]) << k;
  }
  EXPECT_EQ(ffmpeg.starts(), 1) << "40 small frames are all kept";
}

TEST(FramePool, AWindowThatSlidesStartsOneDecoderWhereFewFramesAreKept) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 40, kPooled);
  const CountedFfmpeg ffmpeg(folder.path());
  FramePool pool({.decoders = 2, .recent_bytes = size_t{3 * 3} * kPooled.width * kPooled.height});
  for (int i = 2; i < 39; ++i) {
    for (int k = i - 2; k <= i; ++k) FrameOf(pool, folder / "a.mp4", k);
  }
  EXPECT_EQ(ffmpeg.starts(), 1);
}

TEST(FramePool, AWindowWithGapsStartsOneDecoder) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 40, kPooled);
  const std::vector<Rgb> all = AllFrames(folder / "a.mp4");
  const CountedFfmpeg ffmpeg(folder.path());
  FramePool pool;
  for (int i = 9; i < 40; ++i) {
    for (const int k : {i - 9, i - 4, i}) ASSERT_EQ(FrameOf(pool, folder / "a.mp4", k), all[k]);
  }
  EXPECT_EQ(ffmpeg.starts(), 1);
}

TEST(FramePool, FramesInAnyOrderMatchASequentialRead) {
  TempDir folder;
  const int count = 35;
  WriteVideo(folder / "a.mp4", count, kPooled);
  WriteVideo(folder / "b.mp4", 12, kPooled);
  const std::vector<Rgb> a = AllFrames(folder / "a.mp4"), b = AllFrames(folder / "b.mp4");
  FramePool pool({.decoders = 2, .recent_bytes = size_t{4 * 3} * kPooled.width * kPooled.height});
  std::minstd_rand next(17);
  for (int i = 0; i < 60; ++i) {
    const auto k = static_cast<int>(next() % count);
    ASSERT_EQ(FrameOf(pool, folder / "a.mp4", k), a[k]) << k;
    ASSERT_EQ(FrameOf(pool, folder / "b.mp4", k % 12), b[k % 12]) << k;
  }
}

TEST(FramePool, IdleDecodersAreLimitedAndCanBeClosed) {
  TempDir folder;
  FramePool pool({.decoders = 2});
  for (const char* name : {"a.mp4", "b.mp4", "c.mp4"}) {
    WriteVideo(folder / name, 8, kPooled);
    FrameOf(pool, folder / name, 1);
  }
  EXPECT_EQ(pool.idle(), 2u);
  pool.Clear();
  EXPECT_EQ(pool.idle(), 0u);
  ExpectNoChildLeft();
}

TEST(FramePool, AnotherFileOfTheSameNameIsAnotherVideo) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 8, kPooled);
  FramePool pool;
  FrameOf(pool, folder / "a.mp4", 3);
  VideoWriter other(folder / "other.mp4", kPooled);
  for (int i = 0; i < 8; ++i) other.Write(Rgb(size_t{3} * kPooled.width * kPooled.height, 200));
  other.Finish();
  fs::rename(folder / "other.mp4", folder / "a.mp4");
  EXPECT_EQ(FrameOf(pool, folder / "a.mp4", 3), AllFrames(folder / "a.mp4")[3]);
}

TEST(FramePool, AnErrorEndsTheDecoderAndTheNextCallWorks) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 8, kPooled);
  FramePool pool;
  FrameOf(pool, folder / "a.mp4", 3);
  ExpectThrow<ArgumentError>([&] { FrameOf(pool, folder / "a.mp4", 8); }, "no frame 8");
  ExpectThrow<IoError>([&] { FrameOf(pool, folder / "none.mp4", 0); }, "none.mp4");
  EXPECT_EQ(pool.idle(), 0u);
  EXPECT_EQ(FrameOf(pool, folder / "a.mp4", 4), AllFrames(folder / "a.mp4")[4]);
}

TEST(FramePool, ManyThreadsReadTheSameVideo) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 30, kPooled);
  const std::vector<Rgb> all = AllFrames(folder / "a.mp4");
  FramePool pool;
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&, t] {
        for (int i = t; i < 30; i += 2) wrong += FrameOf(pool, folder / "a.mp4", i) != all[i];
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(FramePool, AForkedChildDoesNotTakeFramesOfItsParent) {
  TempDir folder;
  WriteVideo(folder / "a.mp4", 30, kPooled);
  const std::vector<Rgb> all = AllFrames(folder / "a.mp4");
  FramePool pool;
  FrameOf(pool, folder / "a.mp4", 5);
  const pid_t child = fork();
  const auto reads_well = [&] {
    bool well = true;
    for (int i = 6; i < 20; ++i) well = well && FrameOf(pool, folder / "a.mp4", i) == all[i];
    return well;
  };
  if (child == 0) {
    const bool well = reads_well();
    pool.Clear();
    _exit(well ? 0 : 1);
  }
  EXPECT_TRUE(reads_well());
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(FrameOf(pool, folder / "a.mp4", 20) == all[20]);
}

}  // namespace
}  // namespace robocell::internal
