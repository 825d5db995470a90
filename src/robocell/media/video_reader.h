// Reads the frames of a video that VideoWriter made, through an ffmpeg child process, in order or
// by index: RGB from an mp4, uint16 from a lossless 16-bit video.
//
//   VideoReader video("pick.mp4");
//   std::vector<uint8_t> rgb(video.frame_bytes());
//   while (video.Next(rgb)) Use(rgb);          // row-major RGB, width * height * 3 bytes
//   video.Read(17, rgb);  // frame 17; starts a new decoder unless it is a few frames ahead
//
// Throws IoError for a file that ends early or does not decode cleanly; it never returns a shorter
// video. One thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "robocell/media/video_info.h"

namespace robocell {

class VideoReader {
 public:
  // Read() decodes on to a frame that is at most this far ahead, because a new decoder costs more.
  static constexpr int64_t kNearAhead = 16;

  // Throws IoError if the file is not a readable mp4 of constant rate, or ffmpeg is missing.
  explicit VideoReader(std::filesystem::path path);
  ~VideoReader();
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;

  const VideoInfo& info() const;
  size_t frame_bytes() const;
  // Returns the index of the frame that Next() will read.
  int64_t position() const;

  // Reads the next frame; returns false after the last. Throws ArgumentError if the buffer does not
  // have frame_bytes(), or the video is of the other kind: bytes are for colour, uint16 for 16
  // bits.
  bool Next(std::span<uint8_t> rgb);
  bool Next(std::span<uint16_t> pixels);
  // Reads frame `index`; position() becomes index + 1. Throws ArgumentError if there is no such
  // frame.
  void Read(int64_t index, std::span<uint8_t> rgb);
  void Read(int64_t index, std::span<uint16_t> pixels);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell
