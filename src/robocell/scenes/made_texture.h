// Private to scenes: textures that are computed from a kind and a seed, and textures of PNG files, in
// the size that a model has room for.
//
//   std::vector<uint8_t> texels(3 * 6 * 64 * 64);
//   FillTexture({.kind = "marble", .seed = 7}, {.side = 64, .faces = 6}, texels);
//
// The same kind, seed and size give the same texels on every machine: only sums, products and
// roundings are used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace robocell::internal {

struct MadeTexture {
  std::string kind;   // of MadeTextures() (spec/randomize_config.h)
  uint32_t seed = 0;  // of colours and pattern
};

// A square of `side` texels that continues at its edges; with six faces the faces of a cube, as the
// engine orders them (+x, -x, +y, -y, +z, -z).
struct TextureSize {
  int side = 64;
  int faces = 1;
  size_t bytes() const {
    return 3 * static_cast<size_t>(side) * static_cast<size_t>(side) * static_cast<size_t>(faces);
  }
};

// Writes red, green, blue of each texel, face after face. Throws NotFoundError, which `place` begins,
// for an unknown kind.
void FillTexture(const MadeTexture& texture, const TextureSize& size, std::span<uint8_t> texels,
                 const std::string& place = "");

// An image, rows from the top.
struct TextureImage {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

// Throws IoError, which names the file, if it is missing, no whole PNG file, or larger than kMostPixels.
// It reads the beginning and the end of the file alone.
void RequirePng(const std::string& file);
inline constexpr int64_t kMostPixels = int64_t{64} << 20;

// Throws IoError, which names the file, if it cannot be read as PNG.
TextureImage ReadPng(const std::string& file);
// Writes the image into every face, scaled.
void FillTexture(const TextureImage& image, const TextureSize& size, std::span<uint8_t> texels);
// Writes the image of a PNG file into every face. The process keeps the texels of recent files, until
// they change.
void FillTextureFromPng(const std::string& file, const TextureSize& size,
                        std::span<uint8_t> texels);

}  // namespace robocell::internal
