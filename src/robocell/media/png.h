// PNG files with 8-bit colour and with 16-bit gray (depth in millimetres), through libpng. Files
// appear complete or not at all. The same pixels give the same bytes.
//
//   WritePng("view.png", RgbImage{640, 480, pixels});
//   GrayImage16 depth = ReadPngGray16("depth.png");
//
// Throws IoError with the file and the reason. Any thread may call these functions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace robocell {

// Row-major from the top left; pixels.size() == 3 * width * height.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;
};

// Row-major from the top left; pixels.size() == width * height.
struct GrayImage16 {
  int width = 0;
  int height = 0;
  std::vector<uint16_t> pixels;
};

// Texts of a PNG by their keywords, which have 1 to 79 Latin-1 characters.
using PngTexts = std::map<std::string, std::string>;

inline constexpr uint64_t kMostPngPixels = uint64_t{1} << 30;  // that are read by default

// Throws ArgumentError if the number of pixels does not fit the size.
std::vector<uint8_t> EncodePng(int width, int height, std::span<const uint8_t> rgb,
                               const PngTexts& texts = {});
std::vector<uint8_t> EncodePng(int width, int height, std::span<const uint16_t> gray);
void WritePng(const std::filesystem::path& path, const RgbImage& image);
void WritePng(const std::filesystem::path& path, const GrayImage16& image);

// Reads any PNG as RGB: palettes and gray are expanded, transparency is dropped, 16 bits are cut to
// 8. Throws IoError for more pixels than `most_pixels`, before they take memory.
RgbImage ReadPngRgb(const std::filesystem::path& path, uint64_t most_pixels = kMostPngPixels);
// Returns the texts of a PNG: tEXt, zTXt and iTXt, also those behind the pixels.
PngTexts ReadPngTexts(const std::filesystem::path& path, uint64_t most_pixels = kMostPngPixels);
// Throws IoError unless the file is 16-bit gray: other depths would silently change units.
GrayImage16 ReadPngGray16(const std::filesystem::path& path);

}  // namespace robocell
