#include "robocell/scenes/made_texture.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/spec/randomize_config.h"

namespace robocell::internal {
namespace {

using Colour = std::array<double, 3>;

// A place on the texture: on its face, 0 to 1, and in space, where the faces of a cube meet.
struct Place {
  double u = 0, v = 0;
  std::array<double, 3> at = {};
};

double Smooth(double t) { return t * t * (3 - 2 * t); }

double Fraction(double x) { return x - std::floor(x); }

// Returns a wave of period 1 between 0 and 1, like a cosine.
double Wave(double x) { return Smooth(std::abs(2 * Fraction(x) - 1)); }

// Returns 0 below `edge`, 1 above, and something between within `width`.
double Step(double edge, double width, double x) {
  return Smooth(std::clamp((x - edge) / width + 0.5, 0.0, 1.0));
}

// Value noise on a lattice that repeats after `period` cells.
class Noise {
 public:
  explicit Noise(uint32_t seed) : seed_(seed) {}

  // Returns a number in 0 to 1 for a place in 0 to 1; `scale` cells per unit.
  double At(const std::array<double, 3>& at, int scale) const {
    std::array<std::array<uint32_t, 2>, 3> cell;
    std::array<double, 3> part;
    for (size_t k = 0; k < 3; ++k) {
      const double x = at[k] * scale;
      const int below = static_cast<int>(x);
      part[k] = Smooth(x - below);
      cell[k][0] = static_cast<uint32_t>(below < scale ? below : 0);
      cell[k][1] = cell[k][0] + 1 < static_cast<uint32_t>(scale) ? cell[k][0] + 1 : 0;
    }
    double sum = 0;
    for (size_t i = 0; i < 2; ++i) {
      if (part[2] == 0 && i == 1) break;  // a face has no depth
      const uint32_t layer = Mixed(seed_ * 0x9e3779b1U, cell[2][i]);
      double rows[2];
      for (size_t j = 0; j < 2; ++j) {
        const uint32_t row = Mixed(layer, cell[1][j]);
        const double left = Value(Mixed(row, cell[0][0])), right = Value(Mixed(row, cell[0][1]));
        rows[j] = left + part[0] * (right - left);
      }
      const double of_layer = rows[0] + part[1] * (rows[1] - rows[0]);
      sum += (i == 1 ? part[2] : 1 - part[2]) * of_layer;
    }
    return sum;
  }
  // Sums several octaves, each of half the size and half the strength.
  double Cloud(const std::array<double, 3>& at, int scale, int octaves) const {
    double sum = 0, strength = 0.5, total = 0;
    for (int i = 0; i < octaves; ++i, scale *= 2, strength /= 2) {
      sum += strength * At(at, scale);
      total += strength;
    }
    return sum / total;
  }

 private:
  static uint32_t Mixed(uint32_t h, uint32_t cell) {
    h = (h ^ cell) * 0x85ebca6bU;
    return h ^ h >> 13;
  }
  static double Value(uint32_t h) {
    h *= 0xc2b2ae35U;
    return static_cast<double>((h ^ h >> 16) & 0xffffU) / 65535.0;
  }

  uint32_t seed_;
};

// The share of the second colour at a place, by kind.
class Pattern {
 public:
  Pattern(const MadeTexture& texture, Rng& rng)
      : kind_(texture.kind),
        noise_(texture.seed),
        count_(2 + static_cast<int>(rng.UniformInt(5))),
        is_across_(rng.UniformInt(2) == 1) {}

  double Share(const Place& place) const {
    const double along = is_across_ ? place.v : place.u, across = is_across_ ? place.u : place.v;
    const double cells = 2.0 * count_;
    if (kind_ == "checker") return (Cell(place.u, cells) + Cell(place.v, cells)) % 2;
    if (kind_ == "stripes") return Cell(along, cells) % 2;
    if (kind_ == "gradient") return Wave(along);
    if (kind_ == "noise") return noise_.Cloud(place.at, 2 * count_, 4);
    if (kind_ == "dots") {
      const double x = Fraction(place.u * count_) - 0.5, y = Fraction(place.v * count_) - 0.5;
      return 1 - Step(0.09, 0.03, x * x + y * y);
    }
    if (kind_ == "bricks") {
      const double row = std::floor(across * cells);
      const double shift = static_cast<int>(row) % 2 == 0 ? 0 : 0.5;
      const double x = Fraction(along * count_ + shift), y = Fraction(across * cells);
      const bool is_joint = x < 0.06 || y < 0.12;
      return is_joint ? 1 : 0.25 * noise_.At(place.at, 8 * count_);
    }
    const double cloud = noise_.Cloud(place.at, 2, 4);
    if (kind_ == "marble") return Wave(count_ * (place.at[0] + place.at[1]) + 3 * cloud);
    // wood: rings that are stretched along the grain
    std::array<double, 3> grain = place.at;
    grain[is_across_ ? 1 : 0] *= 0;
    const double fine = noise_.Cloud(grain, 16, 2);
    const double ring = Wave(count_ * (is_across_ ? place.at[0] : place.at[1]) + 1.5 * cloud);
    return 0.65 * ring + 0.35 * fine;
  }

 private:
  static int Cell(double x, double cells) { return static_cast<int>(std::floor(x * cells)); }

  const std::string& kind_;
  Noise noise_;
  int count_;
  bool is_across_;
};

// Returns the direction of a texel from the middle of the cube, in 0 to 1 along each axis.
std::array<double, 3> OnCube(int face, double u, double v) {
  switch (face) {
    case 0:
      return {1, 1 - v, 1 - u};
    case 1:
      return {0, 1 - v, u};
    case 2:
      return {u, 1, v};
    case 3:
      return {u, 0, 1 - v};
    case 4:
      return {u, 1 - v, 1};
    default:
      return {1 - u, 1 - v, 0};
  }
}

Colour DrawColour(Rng& rng) {
  Colour colour;
  for (double& part : colour) part = rng.Uniform(0.08, 0.95);
  return colour;
}

// Wood and marble are of one hue: the second colour is a shade of the first.
Colour ShadeOf(const Colour& colour, Rng& rng) {
  const double shade = rng.Uniform(0.45, 0.75);
  return {shade * colour[0], shade * colour[1], shade * colour[2]};
}

uint8_t Byte(double part) {
  return static_cast<uint8_t>(std::floor(255 * std::clamp(part, 0.0, 1.0) + 0.5));
}

}  // namespace

void FillTexture(const MadeTexture& texture, const TextureSize& size, std::span<uint8_t> texels,
                 const std::string& place) {
  const std::vector<std::string> known = MadeTextures();
  if (std::ranges::find(known, texture.kind) == known.end())
    throw NotFoundError(NoSuchName(place, "texture", texture.kind, known));
  Rng rng = Rng::Stream(texture.seed, "made texture", texture.kind);
  Pattern pattern(texture, rng);
  const Colour first = DrawColour(rng);
  const bool is_shade = texture.kind == "wood" || texture.kind == "marble";
  const Colour second = is_shade ? ShadeOf(first, rng) : DrawColour(rng);
  uint8_t* next = texels.data();
  for (int face = 0; face < size.faces; ++face) {
    for (int row = 0; row < size.side; ++row) {
      for (int column = 0; column < size.side; ++column) {
        Place place{.u = (column + 0.5) / size.side, .v = (row + 0.5) / size.side};
        place.at = size.faces == 6 ? OnCube(face, place.u, place.v)
                                   : std::array<double, 3>{place.u, place.v, 0};
        const double share = pattern.Share(place);
        for (size_t k = 0; k < 3; ++k) *next++ = Byte(first[k] + share * (second[k] - first[k]));
      }
    }
  }
}

void RequirePng(const std::string& file) {
  const std::string place = "texture '" + file + "'";
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw IoError(place + ": there is no such file");
  // The signature, the header with the size, and the chunk that ends every file.
  constexpr std::array<uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<uint8_t, 12> kEnd = {0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
  std::array<uint8_t, 24> begin = {};
  std::array<uint8_t, 12> end = {};
  std::ifstream in(file, std::ios::binary);
  const auto read = [&](auto& bytes) {
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  read(begin);
  in.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  read(end);
  if (!in) throw IoError(place + ": it cannot be read as PNG: it is too short or not readable");
  if (!std::equal(kSignature.begin(), kSignature.end(), begin.begin()))
    throw IoError(place + ": it cannot be read as PNG: it does not begin like one");
  if (end != kEnd) throw IoError(place + ": it cannot be read as PNG: its end is missing");
  const auto number = [&](size_t at) {
    return static_cast<int64_t>(begin[at]) << 24 | static_cast<int64_t>(begin[at + 1]) << 16 |
           static_cast<int64_t>(begin[at + 2]) << 8 | static_cast<int64_t>(begin[at + 3]);
  };
  const int64_t width = number(16), height = number(20);
  if (width > kMostPixels || height > kMostPixels || width * height > kMostPixels) {
    throw IoError(fmt::format(
        "{}: it has {} x {} pixels; at most {} in all, of which 256 x 256 are shown. Scale it down",
        place, width, height, kMostPixels));
  }
}

TextureImage ReadPng(const std::string& file) {
  RequirePng(file);
  const std::string place = "texture '" + file + "'";
  const SpecPtr spec = MakeSpec();
  mjsTexture* texture = mjs_addTexture(spec.get(), nullptr);
  mjs_setName(texture->element, "image");
  texture->type = mjTEXTURE_2D;
  texture->nchannel = 3;
  mjs_setString(texture->file, file.c_str());
  mjs_setString(texture->content_type, "image/png");
  ModelPtr model;
  try {
    model = Compile(spec.get(), nullptr, place);
  } catch (const Error& problem) {
    throw IoError(fmt::format("{}: it cannot be read as PNG: {}", place, problem.what()));
  }
  TextureImage image{.width = model->tex_width[0], .height = model->tex_height[0], .rgb = {}};
  const mjtByte* texels = model->tex_data + model->tex_adr[0];
  image.rgb.assign(texels, texels + 3 * static_cast<ptrdiff_t>(image.width) * image.height);
  return image;
}

void FillTexture(const TextureImage& image, const TextureSize& size, std::span<uint8_t> texels) {
  const auto texel = [&](int column, int row, size_t k) {
    const auto at =
        static_cast<size_t>(row) * static_cast<size_t>(image.width) + static_cast<size_t>(column);
    return static_cast<double>(image.rgb[3 * at + k]);
  };
  // Means over the area of a texel, so that fine structures do not flicker.
  const auto range = [&](int i, int count) {
    const int from = static_cast<int>(static_cast<int64_t>(i) * count / size.side);
    const int to = static_cast<int>(static_cast<int64_t>(i + 1) * count / size.side);
    return std::pair(from, std::max(from + 1, to));
  };
  std::vector<uint8_t> face(3 * static_cast<size_t>(size.side) * static_cast<size_t>(size.side));
  uint8_t* next = face.data();
  for (int i = 0; i < size.side; ++i) {
    const auto [top, bottom] = range(i, image.height);
    for (int j = 0; j < size.side; ++j) {
      const auto [left, right] = range(j, image.width);
      for (size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (int row = top; row < bottom; ++row) {
          for (int column = left; column < right; ++column) sum += texel(column, row, k);
        }
        *next++ = Byte(sum / ((bottom - top) * (right - left)) / 255);
      }
    }
  }
  for (int f = 0; f < size.faces; ++f)
    std::ranges::copy(face, texels.begin() + static_cast<ptrdiff_t>(face.size()) * f);
}

namespace {

struct KnownPng {
  std::filesystem::file_time_type written;
  uintmax_t bytes = 0;
  std::vector<uint8_t> texels;
};

// Texels of files in the sizes that they were drawn in: one of a large image takes a second to decode,
// and every start draws again.
struct KnownPngs {
  static constexpr size_t kMost = 128;  // 50 MB in the sizes of the studio
  std::mutex mutex;
  std::map<std::tuple<std::string, int, int>, KnownPng> all;
};

KnownPngs& AllPngs() {
  static auto* all = new KnownPngs;
  return *all;
}

}  // namespace

void FillTextureFromPng(const std::string& file, const TextureSize& size,
                        std::span<uint8_t> texels) {
  std::error_code error;
  KnownPng now{.written = std::filesystem::last_write_time(file, error),
               .bytes = error ? 0 : std::filesystem::file_size(file, error),
               .texels = {}};
  const std::tuple key(file, size.side, size.faces);
  KnownPngs& pngs = AllPngs();
  if (!error) {
    const std::lock_guard lock(pngs.mutex);
    const auto found = pngs.all.find(key);
    if (found != pngs.all.end() && found->second.written == now.written &&
        found->second.bytes == now.bytes) {
      std::ranges::copy(found->second.texels, texels.begin());
      return;
    }
  }
  now.texels.resize(size.bytes());
  FillTexture(ReadPng(file), size, now.texels);
  std::ranges::copy(now.texels, texels.begin());
  const std::lock_guard lock(pngs.mutex);
  if (pngs.all.size() >= KnownPngs::kMost) pngs.all.clear();
  pngs.all.insert_or_assign(key, std::move(now));
}

}  // namespace robocell::internal
