// For tests only: RGB frames and depth images with smooth shading, edges and motion, and the
// difference of two images.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace robocell {

// Returns frame `index` of a moving square over a gradient: every frame differs from its
// neighbours.
inline std::vector<uint8_t> TestFrame(int width, int height, int index) {
  std::vector<uint8_t> rgb;
  rgb.reserve(size_t{3} * width * height);
  const int left = 7 * index % width;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool square = x >= left && x < left + width / 5 && y > height / 4 && y < height / 2;
      rgb.push_back(static_cast<uint8_t>(square ? 220 : 255 * x / width));
      rgb.push_back(static_cast<uint8_t>(square ? 60 : 255 * y / height));
      rgb.push_back(static_cast<uint8_t>(square ? 40 : 120));
    }
  }
  return rgb;
}

// Returns depth image `index`: a slope with a moving hole, and noise over all 16 bits in the lower
// half.
inline std::vector<uint16_t> TestDepth(int width, int height, int index) {
  std::vector<uint16_t> depth;
  depth.reserve(size_t{1} * width * height);
  uint32_t noise = 12345u + static_cast<uint32_t>(index);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      noise = 1664525u * noise + 1013904223u;
      const bool hole = x >= 3 * index % width && y < height / 4;
      const int slope = hole ? 0 : 700 + 3 * x + 5 * y + index;
      depth.push_back(static_cast<uint16_t>(2 * y < height ? slope : noise >> 16));
    }
  }
  depth.front() = 0;
  depth.back() = 65535;
  return depth;
}

// Returns the peak signal-to-noise ratio in dB.
inline double Psnr(std::span<const uint8_t> a, std::span<const uint8_t> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum);
}

}  // namespace robocell
