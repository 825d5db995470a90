// For tests only: small videos of test frames, files of any bytes, and checks that the encoder
// leaves nothing behind.
#pragma once

#include <sys/wait.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>

#include "robocell/media/testing/frames.h"
#include "robocell/media/video_writer.h"
#include "robocell/media/warm_program.h"

namespace robocell {

inline void WriteVideo(const std::filesystem::path& path, int frames, const VideoOptions& options) {
  VideoWriter video(path, options);
  for (int i = 0; i < frames; ++i) video.Write(TestFrame(options.width, options.height, i));
  video.Finish();
}

// Skips the flush to the disk of AtomicWrite, because it runs hundreds of times.
inline void Store(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// Expects that this process has no child, running or waiting to be reaped. Ends the process that
// waits to become the next encoder (warm_program.h).
inline void ExpectNoChildLeft() {
  internal::EndWarmPrograms();
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace robocell
