// Converts RGB images to planar YUV 4:2:0, the input format of H.264 encoders: a luma plane of full
// size, then two chroma planes of half its width and height.
//
//   Yuv420Converter convert(640, 480);
//   std::span<const uint8_t> yuv = convert(rgb);  // 640 * 480 * 3 / 2 bytes, until the next call
//
// Luma and chroma follow ITU-R BT.601 in its limited range (Y 16 to 235, Cb and Cr 16 to 240). A
// chroma sample is the mean of the 2 x 2 pixels around it, the place that ffmpeg and programs based
// on it assume by default. The arithmetic uses whole numbers, so that the same pixels give the same
// bytes on every processor.
//
// Not thread-safe: a converter owns its buffers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace robocell::internal {

class Yuv420Converter {
 public:
  // Throws ArgumentError unless width and height are even and positive.
  Yuv420Converter(int width, int height);

  // `rgb`: rows from the top, 3 bytes a pixel, 3 * width * height bytes (ArgumentError otherwise).
  std::span<const uint8_t> operator()(std::span<const uint8_t> rgb);

 private:
  int width_, height_;
  std::vector<uint8_t> yuv_;
  std::vector<int16_t> sums_;  // sums of two rows, by channel
};

}  // namespace robocell::internal
