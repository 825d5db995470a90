// For tests only: RGB frames with smooth shading, edges and motion, and how much two images differ.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace robocell {

// Frame `index` of a moving square over a gradient: every frame is different from its neighbours.
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

// Peak signal to noise ratio in dB.
inline double Psnr(std::span<const uint8_t> a, std::span<const uint8_t> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum);
}

}  // namespace robocell
