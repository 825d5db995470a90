// For tests only: measures the content of videos and images, independently of the renderer.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "robocell/media/video_reader.h"

namespace robocell {

// Returns all frames of a file, rows from the top, 3 bytes a pixel.
inline std::vector<std::vector<uint8_t>> FramesOf(const std::filesystem::path& file) {
  VideoReader reader(file);
  std::vector<std::vector<uint8_t>> frames;
  std::vector<uint8_t> rgb(reader.frame_bytes());
  while (reader.Next(rgb)) frames.push_back(rgb);
  return frames;
}

// Returns the similarity of two images, decibels; a compressed copy of a small image has some 30.
inline double Psnr(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum);
}

// Returns the row with most of the red in each frame, in pixels from the top; NaN without red.
// Frames are `width` pixels wide.
inline std::vector<double> RowsOfRed(const std::filesystem::path& file, size_t width = 64) {
  std::vector<double> rows;
  for (const std::vector<uint8_t>& rgb : FramesOf(file)) {
    double sum = 0, red = 0;
    for (size_t pixel = 0; pixel < rgb.size() / 3; ++pixel) {
      if (rgb[3 * pixel] < 100 || rgb[3 * pixel + 1] > 80) continue;
      sum += static_cast<double>(pixel / width);
      ++red;
    }
    rows.push_back(red > 0 ? sum / red : NAN);
  }
  return rows;
}

}  // namespace robocell
