// Smooth edges from the samples beside them; part of soft_kernel.cc, compiled for each instruction
// set. A sample has the colour of a pixel that shows the same surface: its own, or one beside it.
// Only samples of surfaces that no such pixel shows are coloured themselves.
#if defined(ROBOCELL_SOFT_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_EDGES_INL_H_
#undef ROBOCELL_SOFT_EDGES_INL_H_
#else
#define ROBOCELL_SOFT_EDGES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_samples-inl.h"
#include "robocell/render/soft_shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

constexpr uint32_t kRedBlue = 0x00ff00ff, kGreen = 0x0000ff00;

struct ImagePlace {
  int x, y;  // pixels

  size_t block(const SoftBuffer& buffer) const {
    return static_cast<size_t>(y / kSoftBlock) * buffer.columns + x / kSoftBlock;
  }
  int pixel() const { return y % kSoftBlock * kSoftBlock + x % kSoftBlock; }
};

// Finds the pixel beside `at` that shows the surface of a sample, the nearest to it first. Returns
// false if there is none.
inline bool FindBeside(const SoftBuffer& buffer, const ImagePlace& at, float right, float down,
                       uint32_t id, float nearness, ImagePlace* found) {
  const int sx = right < 0 ? -1 : 1, sy = down < 0 ? -1 : 1;
  const bool across = std::abs(right) >= std::abs(down);
  const ImagePlace steps[] = {across ? ImagePlace{sx, 0} : ImagePlace{0, sy},
                              across ? ImagePlace{0, sy} : ImagePlace{sx, 0},
                              {sx, sy},
                              {-sx, 0},
                              {0, -sy},
                              {sx, -sy},
                              {-sx, sy},
                              {-sx, -sy}};
  for (const ImagePlace& step : steps) {
    const ImagePlace there{at.x + step.x, at.y + step.y};
    if (there.x < 0 || there.y < 0 || there.x >= buffer.width || there.y >= buffer.height) continue;
    const size_t block = there.block(buffer);
    const int pixel = there.pixel();
    if ((buffer.ids[block].at[pixel] ^ id) >> kSoftRunBits != 0) continue;
    const float apart = std::abs(buffer.nearness[block].at[pixel] - nearness);
    if (apart > 2 * kOneSurface * nearness) continue;
    *found = there;
    return true;
  }
  return false;
}

// Sums the samples of one block; those that must be coloured are added to the strays.
HWY_INLINE void SumBlock(const SoftBuffer& buffer, SoftSamples* samples, const SoftIds* colours,
                         int bx, int by, int32_t slot, std::vector<SoftStray>* strays) {
  const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
  uint32_t* red_blue = samples->red_blue[static_cast<size_t>(slot)].at;
  uint32_t* green = samples->green[static_cast<size_t>(slot)].at;
  for (int part = 0; part < kSoftPixels; part += kLanes) {
    const I ids = hn::Load(kInts, reinterpret_cast<const int32_t*>(buffer.ids[block].at) + part);
    const V nearness = hn::Load(kFloats, buffer.nearness[block].at + part);
    const I colour = hn::Load(kInts, reinterpret_cast<const int32_t*>(colours[block].at) + part);
    const I own_red_blue = hn::And(colour, hn::Set(kInts, kRedBlue)),
            own_green = hn::And(colour, hn::Set(kInts, kGreen));
    const V close = hn::Mul(Num(kOneSurface), nearness);
    I sum_red_blue = hn::Zero(kInts), sum_green = hn::Zero(kInts);
    uint32_t other[kSoftMostSamples];
    for (int s = 0; s < samples->count; ++s) {
      const size_t at = samples->At(slot, s);
      const I of_sample =
          hn::Load(kInts, reinterpret_cast<const int32_t*>(samples->ids[at].at) + part);
      const V near = hn::Load(kFloats, samples->nearness[at].at + part);
      const M same =
          hn::And(InOneRun(ids, of_sample), hn::Le(hn::Abs(hn::Sub(near, nearness)), close));
      const auto here = hn::RebindMask(kInts, same);
      sum_red_blue = hn::Add(sum_red_blue, hn::IfThenElseZero(here, own_red_blue));
      sum_green = hn::Add(sum_green, hn::IfThenElseZero(here, own_green));
      uint8_t bits[8] = {};
      hn::StoreMaskBits(kFloats, hn::Not(same), bits);
      other[s] = static_cast<uint32_t>(bits[0] | bits[1] << 8) & ((1u << kLanes) - 1);
    }
    hn::Store(sum_red_blue, kInts, reinterpret_cast<int32_t*>(red_blue) + part);
    hn::Store(sum_green, kInts, reinterpret_cast<int32_t*>(green) + part);
    for (int s = 0; s < samples->count; ++s) {
      const size_t at = samples->At(slot, s);
      for (uint32_t rest = other[s]; rest != 0; rest &= rest - 1) {
        const int pixel = part + __builtin_ctz(rest);
        const uint32_t id = samples->ids[at].at[pixel];
        const float near = samples->nearness[at].at[pixel];
        const ImagePlace here{kSoftBlock * bx + pixel % kSoftBlock,
                              kSoftBlock * by + pixel / kSoftBlock};
        ImagePlace found{};
        if (FindBeside(buffer, here, samples->right[s], samples->down[s], id, near, &found)) {
          const uint32_t c = colours[found.block(buffer)].at[found.pixel()];
          red_blue[pixel] += c & kRedBlue;
          green[pixel] += c & kGreen;
        } else if (here.x < buffer.width && here.y < buffer.height) {
          strays->push_back({static_cast<float>(here.x) + samples->right[s],
                             static_cast<float>(here.y) + samples->down[s], near, id, slot, pixel});
        }
      }
    }
  }
}

// Colours the strays and adds them to the sums, a register at a time.
inline void AddStrays(const SoftPicture& picture, const std::vector<SoftStray>& strays,
                      SoftSamples* samples) {
  SoftFace face;
  for (size_t i = 0; i < strays.size(); i += kLanes) {
    const size_t count = std::min(strays.size() - i, static_cast<size_t>(kLanes));
    alignas(64) float x[kSoftPixels] = {}, y[kSoftPixels] = {}, nearness[kSoftPixels] = {};
    alignas(64) int32_t ids[kSoftPixels], colours[kSoftPixels];
    std::fill_n(ids, kSoftPixels, -1);
    for (size_t k = 0; k < count; ++k) {
      x[k] = strays[i + k].x;
      y[k] = strays[i + k].y;
      nearness[k] = strays[i + k].nearness;
      ids[k] = static_cast<int32_t>(strays[i + k].id);
    }
    const I id = hn::Load(kInts, ids);
    const Pixels p = PixelsThrough(*picture.view, hn::Load(kFloats, x), hn::Load(kFloats, y),
                                   hn::Load(kFloats, nearness));
    const M nothing = hn::RebindMask(kFloats, hn::Lt(id, hn::Zero(kInts)));
    hn::Store(PackPixels(WithSky(picture, p, nothing, ShadePixels(picture, p, id, &face))), kInts,
              colours);
    for (size_t k = 0; k < count; ++k) {
      const auto c = static_cast<uint32_t>(colours[k]);
      const auto slot = static_cast<size_t>(strays[i + k].slot);
      samples->red_blue[slot].at[strays[i + k].pixel] += c & kRedBlue;
      samples->green[slot].at[strays[i + k].pixel] += c & kGreen;
    }
  }
}

// Sums of the samples of some rows. The colours of all rows are read.
inline void SumSamplesHere(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                           const SoftIds* colours, std::vector<SoftStray>* strays,
                           SoftSamples* samples) {
  strays->clear();
  for (int by = rows.begin; by < rows.end; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const int32_t slot = samples->slots[static_cast<size_t>(by) * buffer.columns + bx];
      if (slot >= 0) SumBlock(buffer, samples, colours, bx, by, slot, strays);
    }
  }
  AddStrays(picture, *strays, samples);
}

// Replaces the colours of some rows by the means.
inline void TakeMeansHere(const SoftSamples& samples, SoftRows rows, SoftIds* colours) {
  // Counts are powers of two.
  const int shift = __builtin_ctz(static_cast<unsigned>(samples.count));
  const uint32_t half = static_cast<uint32_t>(samples.count) / 2;
  const auto columns = static_cast<size_t>(samples.columns);
  for (size_t block = columns * static_cast<size_t>(rows.begin);
       block < columns * static_cast<size_t>(rows.end); ++block) {
    const int32_t slot = samples.slots[block];
    if (slot < 0) continue;
    const uint32_t* red_blue = samples.red_blue[static_cast<size_t>(slot)].at;
    const uint32_t* green = samples.green[static_cast<size_t>(slot)].at;
    for (int k = 0; k < kSoftPixels; ++k) {
      colours[block].at[k] = ((red_blue[k] + (half | half << 16)) >> shift & kRedBlue) |
                             ((green[k] + (half << 8)) >> shift & kGreen);
    }
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
