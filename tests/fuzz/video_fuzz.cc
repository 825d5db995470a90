// Fuzzes a video file of any bytes: its tables are returned or rejected with an Error, and returned
// ones are consistent.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/testing/temp_dir.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static auto* folder = new robocell::TempDir;
  const std::filesystem::path file = folder->path() / "video.mp4";
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const robocell::VideoInfo info = robocell::ReadVideoInfo(file);
    if (info.frames < 0 || info.width < 0 || info.height < 0 || info.fps_num < 0 ||
        info.fps_den < 1)
      std::abort();
  } catch (const robocell::Error&) {
    return 0;  // a rejection is fine
  }
  return 0;
}
