#include "robocell/render/soft_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace robocell::internal {
namespace {

// The engine draws with unconverted colours; those of an sRGB texture are made linear first.
std::array<uint8_t, 256> LinearFromSrgb() {
  std::array<uint8_t, 256> table{};
  for (int i = 0; i < 256; ++i) {
    const double c = i / 255.0;
    const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    table[static_cast<size_t>(i)] = static_cast<uint8_t>(std::lround(255 * linear));
  }
  return table;
}

}  // namespace

SoftTexture::SoftTexture(const mjModel* m, int texture) {
  const int channels = m->tex_nchannel[texture];
  if (channels != 3 && channels != 4) return;  // encoded ones are for other renderers
  sky = m->tex_type[texture] == mjTEXTURE_SKYBOX;
  cube = m->tex_type[texture] != mjTEXTURE_2D;
  width = m->tex_width[texture];
  height = cube ? width : m->tex_height[texture];
  const int faces = cube ? 6 : 1;
  const bool one_face = cube && m->tex_width[texture] == m->tex_height[texture];
  const bool linear = m->tex_colorspace[texture] == mjCOLORSPACE_SRGB && !cube;
  const std::array<uint8_t, 256> table = LinearFromSrgb();
  const size_t face_size = static_cast<size_t>(width) * static_cast<size_t>(height);
  const mjtByte* data = m->tex_data + m->tex_adr[texture];
  texels.reserve(face_size * static_cast<size_t>(faces) * 4 / 3 + 64);
  for (int face = 0; face < faces; ++face) {
    const mjtByte* from =
        data +
        (one_face ? 0 : static_cast<size_t>(face) * face_size * static_cast<size_t>(channels));
    for (size_t i = 0; i < face_size; ++i, from += channels) {
      uint32_t texel = 0;
      for (int c = 0; c < 3; ++c) {
        texel |= static_cast<uint32_t>(linear ? table[from[c]] : from[c]) << (8 * c);
      }
      texels.push_back(texel);
      if ((i + 1) % static_cast<size_t>(width) == 0) EndRow();
    }
  }
  level_width = {width};
  level_height = {height};
  level_start = {0};
  AddSmallerLevels(faces);
  MarkPlain(faces);
  if (!cube) MarkWide();
  levels = static_cast<int>(level_width.size());
}

void SoftTexture::EndRow() {
  const int row = level_width.empty() ? width : level_width.back();
  texels.push_back(cube ? texels.back() : texels[texels.size() - static_cast<size_t>(row)]);
}

void SoftTexture::AddSmallerLevels(int faces) {
  for (int w = width, h = height; w > 1 || h > 1;) {
    const int from_w = w, from_h = h;
    const auto from_start = static_cast<size_t>(level_start.back());
    w = std::max(1, w / 2);
    h = std::max(1, h / 2);
    level_width.push_back(w);
    level_height.push_back(h);
    level_start.push_back(static_cast<int32_t>(texels.size()));
    for (int face = 0; face < faces; ++face) {
      const size_t from = from_start + static_cast<size_t>(face) * static_cast<size_t>(from_w + 1) *
                                           static_cast<size_t>(from_h);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          uint32_t sum[3] = {};
          for (int k = 0; k < 4; ++k) {
            const int sx = std::min(2 * x + (k & 1), from_w - 1),
                      sy = std::min(2 * y + (k >> 1), from_h - 1);
            const uint32_t texel =
                texels[from + static_cast<size_t>(sy) * static_cast<size_t>(from_w + 1) +
                       static_cast<size_t>(sx)];
            for (int c = 0; c < 3; ++c) sum[c] += texel >> (8 * c) & 255;
          }
          uint32_t texel = 0;
          for (int c = 0; c < 3; ++c) texel |= (sum[c] + 2) / 4 << (8 * c);
          texels.push_back(texel);
        }
        EndRow();
      }
    }
  }
}

void SoftTexture::MarkPlain(int faces) {
  constexpr uint32_t kColour = 0xffffffu;
  for (size_t level = 0; level < level_width.size(); ++level) {
    const auto w = static_cast<size_t>(level_width[level]),
               h = static_cast<size_t>(level_height[level]);
    for (size_t face = 0; face < static_cast<size_t>(faces); ++face) {
      uint32_t* rows = &texels[static_cast<size_t>(level_start[level]) + face * (w + 1) * h];
      for (size_t y = 0; y < h; ++y) {
        const size_t next = y + 1 < h ? y + 1 : cube ? y : 0;
        uint32_t *here = rows + y * (w + 1), *below = rows + next * (w + 1);
        for (size_t x = 0; x < w; ++x) {
          const uint32_t other =
              (here[x] ^ here[x + 1]) | (here[x] ^ below[x]) | (here[x] ^ below[x + 1]);
          here[x] = (here[x] & kColour) | ((other & kColour) == 0 ? kSoftPlain : 0);
        }
      }
    }
  }
}

// Four squares that overlap or touch make a larger one: of 2, 3, 5, 9 and 13 texels. Tiles repeat.
void SoftTexture::MarkWide() {
  std::vector<uint8_t> is_one, larger;
  for (size_t level = 0; level < level_width.size(); ++level) {
    const auto w = static_cast<size_t>(level_width[level]),
               h = static_cast<size_t>(level_height[level]);
    uint32_t* rows = &texels[static_cast<size_t>(level_start[level])];
    is_one.assign(w * h, 0);
    bool is_any = false;
    for (size_t y = 0; y < h; ++y) {
      for (size_t x = 0; x < w; ++x) {
        is_one[y * w + x] = (rows[y * (w + 1) + x] & kSoftPlain) != 0;
        is_any |= is_one[y * w + x] != 0;
      }
    }
    larger.resize(w * h);
    const auto grow = [&](size_t step, uint32_t mark) {
      if (!is_any) return;
      is_any = false;
      for (size_t y = 0; y < h; ++y) {
        const uint8_t *here = &is_one[y * w], *below = &is_one[(y + step) % h * w];
        for (size_t x = 0; x < w; ++x) {
          const size_t right = (x + step) % w;
          const auto all = static_cast<uint8_t>(here[x] & here[right] & below[x] & below[right]);
          larger[y * w + x] = all;
          is_any |= all != 0;
          if (all) rows[y * (w + 1) + x] |= mark;
        }
      }
      std::swap(is_one, larger);
    };
    grow(1, 0);
    grow(2, 0);
    grow(4, kSoftWide);
    grow(4, kSoftWider);
  }
}

}  // namespace robocell::internal
