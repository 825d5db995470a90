// Single frames of videos, for access in any order.
//
//   FramePool& frames = FramePool::Shared();
//   frames.Read("wrist.mp4", 17, rgb);
//   frames.Read("wrist.mp4", 18, rgb);  // the decoder of frame 17 continues
//   frames.Read("wrist.mp4", 16, rgb);  // decoded not long ago: copied
//
// Starting a decoder costs as much as decoding tens of small frames, so decoders stay alive between
// calls: one process for each of the most recently read videos. Each also keeps the frames that it
// decoded last. Another file of the same name is another video. Throws the errors of VideoReader.
//
// Any thread may use it; two threads that read the same video at once have a decoder each. A forked
// child starts its own decoders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace robocell::internal {

struct FramePoolOptions {
  size_t decoders = 8;                    // idle ones to keep, for each kind of video
  size_t recent_bytes = size_t{8} << 20;  // decoded frames of each file, bytes
};

class FramePool {
 public:
  explicit FramePool(const FramePoolOptions& options = {});
  ~FramePool();
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;

  // Returns the pool that all episodes of this process use.
  static FramePool& Shared();

  // Reads frame `index` like VideoReader::Read.
  void Read(const std::filesystem::path& video, int64_t index, std::span<uint8_t> rgb);
  void Read(const std::filesystem::path& video, int64_t index, std::span<uint16_t> pixels);

  // Ends the idle decoders, and forgets their frames.
  void Clear();
  size_t idle() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell::internal
