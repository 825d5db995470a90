#include "robocell/scenes/houses/house_textures.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "robocell/media/png.h"

namespace robocell::internal {
namespace {

constexpr int kSize = 256;

// A random number from 0 to 1 for a point of a lattice (a hash by multiplication and shifts).
double Lattice(int x, int y, uint32_t seed) {
  uint32_t h = static_cast<uint32_t>(x) * 0x8da6b343U ^ static_cast<uint32_t>(y) * 0xd8163841U ^
               seed * 0xcb1ab31fU;
  h ^= h >> 15;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12;
  h *= 0x297a2d39U;
  h ^= h >> 15;
  return h / 4294967295.0;
}

// Value noise that repeats after nx by ny cells over the texture.
double Noise(double u, double v, int nx, int ny, uint32_t seed) {
  const double x = u * nx, y = v * ny;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double a = smooth(x - i), b = smooth(y - j);
  const auto at = [&](int k, int l) {
    return Lattice((k % nx + nx) % nx, (l % ny + ny) % ny, seed);
  };
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
         b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

// Brightness of the patterns, 0 to 1.
double Grain(double u, double v, uint32_t seed) {
  const double bend = 0.03 * Noise(u, v, 3, 4, seed);
  const double streaks = Noise(u, v + bend, 2, 24, seed + 1);
  const double fine = Noise(u, v + bend, 6, 96, seed + 2);
  return 0.74 + 0.18 * streaks + 0.08 * fine;
}
double WoodPattern(double u, double v) { return Grain(u, v, 11); }
double PlankPattern(double u, double v) {
  constexpr int kRows = 6;
  const int row = static_cast<int>(v * kRows);
  const double across = v * kRows - row;
  const double start = Lattice(row, 0, 31);
  const double along = u + start - std::floor(u + start);
  const double seam = 0.008;
  const bool is_seam = across < 6 * seam || along < seam;
  const double board = 0.86 + 0.14 * Lattice(row, 7, 33);
  return is_seam ? 0.5 : board * Grain(u + 0.37 * row - std::floor(u + 0.37 * row), v, 35);
}
double TilePattern(double u, double v) {
  constexpr int kTiles = 4;
  const double x = u * kTiles - std::floor(u * kTiles), y = v * kTiles - std::floor(v * kTiles);
  const double edge = std::min({x, y, 1 - x, 1 - y});
  if (edge < 0.02) return 0.68;
  const double own = Lattice(static_cast<int>(u * kTiles), static_cast<int>(v * kTiles), 41);
  return 0.93 + 0.04 * own + 0.03 * Noise(u, v, 32, 32, 42);
}
double PlasterPattern(double u, double v) {
  return 0.94 + 0.03 * Noise(u, v, 12, 12, 51) + 0.03 * Noise(u, v, 80, 80, 52);
}
double FabricPattern(double u, double v) {
  constexpr int kThreads = 48;
  const int i = static_cast<int>(u * kThreads), j = static_cast<int>(v * kThreads);
  const double x = u * kThreads - i - 0.5, y = v * kThreads - j - 0.5;
  const bool warp = (i + j) % 2 == 0;
  const double bulge = 1 - 2.4 * (warp ? x * x : y * y);
  return 0.62 + 0.3 * bulge + 0.08 * Noise(u, v, 24, 24, 61);
}
double ConcretePattern(double u, double v) {
  return 0.8 + 0.12 * Noise(u, v, 6, 6, 71) + 0.05 * Noise(u, v, 24, 24, 72) +
         0.05 * Noise(u, v, 110, 110, 73);
}

std::vector<uint8_t> Draw(const std::function<double(double, double)>& brightness) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double value = brightness((x + 0.5) / kSize, (y + 0.5) / kSize);
      const auto byte = static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
      pixels.insert(pixels.end(), 3, byte);
    }
  }
  return EncodePng(kSize, kSize, pixels);
}

}  // namespace

const std::vector<HouseTexture>& HouseTextures() {
  static const std::vector<HouseTexture> kTextures = {
      {"wood", Draw(WoodPattern)},     {"planks", Draw(PlankPattern)},
      {"tile", Draw(TilePattern)},     {"plaster", Draw(PlasterPattern)},
      {"fabric", Draw(FabricPattern)}, {"concrete", Draw(ConcretePattern)}};
  return kTextures;
}

const std::vector<HouseMaterial>& HouseMaterials() {
  static const std::vector<HouseMaterial> kMaterials = {
      {"floor_wood", "planks", {0.83F, 0.64F, 0.45F, 1}, 0.9F, 0.3F, 0.4F},
      {"floor_tile", "tile", {0.92F, 0.91F, 0.88F, 1}, 0.8F, 0.4F, 0.5F},
      {"floor_carpet", "fabric", {0.68F, 0.68F, 0.7F, 1}, 2.0F, 0, 0},
      {"floor_concrete", "concrete", {0.78F, 0.78F, 0.77F, 1}, 0.5F, 0.1F, 0.1F},
      {"wall", "plaster", {0.95F, 0.93F, 0.89F, 1}, 1.0F, 0, 0},
      {"ceiling", "plaster", {0.98F, 0.98F, 0.97F, 1}, 1.0F, 0, 0, 0.4F},
      {"frame", "", {0.96F, 0.96F, 0.95F, 1}, 1},
      {"door", "wood", {0.93F, 0.88F, 0.8F, 1}, 1.0F},
      {"glass", "", {0.75F, 0.87F, 0.93F, 0.3F}, 1, 0.8F, 0.9F},
      {"glass_dark", "", {0.06F, 0.06F, 0.07F, 1}, 1, 0.8F, 0.9F},
      {"oak", "wood", {0.8F, 0.6F, 0.38F, 1}, 1.2F},
      {"walnut", "wood", {0.5F, 0.34F, 0.23F, 1}, 1.2F},
      {"pine", "wood", {0.9F, 0.75F, 0.52F, 1}, 1.2F},
      {"cabinet", "plaster", {0.88F, 0.87F, 0.84F, 1}, 1.0F},
      {"cabinet_front", "wood", {0.45F, 0.58F, 0.6F, 1}, 1.0F},
      {"worktop", "concrete", {0.42F, 0.4F, 0.38F, 1}, 2.0F, 0.4F, 0.5F},
      {"enamel", "", {0.93F, 0.93F, 0.92F, 1}, 1, 0.5F, 0.6F},
      {"steel", "", {0.72F, 0.74F, 0.76F, 1}, 1, 0.7F, 0.7F},
      {"iron", "", {0.28F, 0.29F, 0.31F, 1}, 1, 0.6F, 0.5F},
      {"steel_blue", "", {0.2F, 0.35F, 0.55F, 1}, 1, 0.4F, 0.4F},
      {"steel_orange", "", {0.9F, 0.45F, 0.12F, 1}, 1, 0.4F, 0.4F},
      {"burner", "", {0.16F, 0.16F, 0.17F, 1}, 1, 0.3F, 0.3F},
      {"dark", "", {0.12F, 0.12F, 0.13F, 1}, 1, 0.3F, 0.3F},
      {"linen", "fabric", {1.0F, 0.99F, 0.96F, 1}, 3.0F, 0, 0},
      {"fabric_blue", "fabric", {0.32F, 0.44F, 0.62F, 1}, 3.0F, 0, 0},
      {"fabric_gray", "fabric", {0.55F, 0.55F, 0.57F, 1}, 3.0F, 0, 0},
      {"fabric_green", "fabric", {0.38F, 0.52F, 0.4F, 1}, 3.0F, 0, 0},
      {"fabric_sand", "fabric", {0.86F, 0.76F, 0.6F, 1}, 3.0F, 0, 0},
      {"cardboard", "plaster", {0.74F, 0.57F, 0.38F, 1}, 1.0F, 0, 0},
      {"terracotta", "", {0.76F, 0.42F, 0.28F, 1}, 1},
      {"leaf", "fabric", {0.3F, 0.58F, 0.26F, 1}, 3.0F},
      {"red", "", {0.8F, 0.2F, 0.17F, 1}, 1, 0.4F, 0.5F},
      {"blue", "", {0.18F, 0.38F, 0.75F, 1}, 1, 0.4F, 0.5F},
      {"green", "", {0.22F, 0.6F, 0.3F, 1}, 1, 0.4F, 0.5F},
      {"yellow", "", {0.95F, 0.78F, 0.2F, 1}, 1, 0.4F, 0.5F},
      {"white", "", {0.95F, 0.95F, 0.93F, 1}, 1, 0.4F, 0.5F},
      {"orange", "", {0.95F, 0.52F, 0.12F, 1}, 1, 0.4F, 0.5F},
      {"teal", "", {0.15F, 0.58F, 0.58F, 1}, 1, 0.4F, 0.5F}};
  return kMaterials;
}

}  // namespace robocell::internal
