// Reads kind, size, frames, rate and encoder of the video in an mp4 or mov file. It reads the
// file's tables itself (a millisecond, no child process), so that every recording can be checked.
// VideoReader decodes.
//
//   VideoInfo info = ReadVideoInfo("wrist.mp4");  // 120 frames, fps_num / fps_den == 500 / 33
//
// Throws IoError with the file and the reason: not an mp4, truncated, no video in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace robocell {

enum class VideoKind {
  kColour,  // RGB, 3 bytes a pixel; h264 in yuv420p, lossy
  // uint16 a pixel, such as depth or ids; FFV1, lossless, every frame a key frame
  kGray16,
};

// Returns the bytes of one frame for writers and readers.
size_t FrameBytes(VideoKind kind, int width, int height);

struct VideoInfo {
  VideoKind kind = VideoKind::kColour;
  int width = 0;   // px
  int height = 0;  // px
  int64_t frames = 0;
  // Frames per second, in lowest terms; exact if `constant_rate`, else the average.
  int64_t fps_num = 0;
  int64_t fps_den = 1;
  bool constant_rate = false;
  std::string encoder;  // "x264 - core 164 r3095 baee400" if the stream names it, else ""
};

VideoInfo ReadVideoInfo(const std::filesystem::path& path);

}  // namespace robocell
