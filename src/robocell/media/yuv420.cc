#include "robocell/media/yuv420.h"

#include <algorithm>

#include <fmt/format.h>

#include "robocell/base/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/media/yuv420.cc"
#define HWY_WANT_AVX3_DL
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Weights of BT.601, limited range, times 2^15.
constexpr int kScaleBits = 15;
constexpr int kLumaR = 8414, kLumaG = 16520, kLumaB = 3208;
constexpr int kCbR = -4857, kCbG = -9535, kCbB = 14392;
constexpr int kCrR = 14392, kCrG = -12052, kCrB = -2340;
constexpr int kLumaOffset = (16 << kScaleBits) + (1 << (kScaleBits - 1));
// A chroma sample comes from the sum of four pixels.
constexpr int kChromaBits = kScaleBits + 2;
constexpr int kChromaOffset = (128 << kChromaBits) + (1 << (kChromaBits - 1));

// Converts as many pixels at a time as a register has 32-bit lanes; the order is kept.
using Ints = hn::CappedTag<int32_t, 16>;
using Shorts = hn::Rebind<int16_t, Ints>;
using Bytes = hn::Rebind<uint8_t, Ints>;
constexpr Ints kInts;
constexpr Shorts kShorts;
constexpr Bytes kBytes;
constexpr size_t kMostLanes = 16;
using VInts = hn::Vec<Ints>;

struct Channels {
  VInts r, g, b;
};

// Returns the weighted sum of the channels, as a byte.
template <int kBits>
HWY_INLINE hn::Vec<Bytes> Weigh(const Channels& in, int r, int g, int b, int offset) {
  const VInts red = hn::Mul(in.r, hn::Set(kInts, r)), green = hn::Mul(in.g, hn::Set(kInts, g));
  const VInts blue = hn::Mul(in.b, hn::Set(kInts, b));
  const VInts sum = hn::Add(hn::Add(red, green), hn::Add(blue, hn::Set(kInts, offset)));
  return hn::DemoteTo(kBytes, hn::ShiftRight<kBits>(sum));
}

HWY_INLINE Channels LoadPixels(const uint8_t* rgb) {
  hn::Vec<Bytes> r, g, b;
  hn::LoadInterleaved3(kBytes, rgb, r, g, b);
  return {hn::PromoteTo(kInts, r), hn::PromoteTo(kInts, g), hn::PromoteTo(kInts, b)};
}

HWY_INLINE void PutLuma(const Channels& in, uint8_t* out) {
  hn::StoreU(Weigh<kScaleBits>(in, kLumaR, kLumaG, kLumaB, kLumaOffset), kBytes, out);
}

// Pixels of two rows: their luma, and their sums by channel.
HWY_INLINE void DoBlock(const uint8_t* upper, const uint8_t* lower, uint8_t* luma_upper,
                        uint8_t* luma_lower, size_t stride, int16_t* sums) {
  const Channels above = LoadPixels(upper), below = LoadPixels(lower);
  PutLuma(above, luma_upper);
  PutLuma(below, luma_lower);
  const auto put = [&](const VInts& a, const VInts& b, int16_t* out) {
    hn::StoreU(hn::DemoteTo(kShorts, hn::Add(a, b)), kShorts, out);
  };
  put(above.r, below.r, sums);
  put(above.g, below.g, sums + stride);
  put(above.b, below.b, sums + 2 * stride);
}

// The last block of a row overlaps the one before it. A row shorter than a block goes through a
// copy.
void ConvertRows(const uint8_t* upper, const uint8_t* lower, size_t width, uint8_t* luma_upper,
                 uint8_t* luma_lower, size_t stride, int16_t* sums) {
  const size_t block = hn::Lanes(kInts);
  if (width < block) {
    uint8_t rows[2][3 * kMostLanes] = {}, luma[2][kMostLanes];
    std::copy_n(upper, 3 * width, rows[0]);
    std::copy_n(lower, 3 * width, rows[1]);
    DoBlock(rows[0], rows[1], luma[0], luma[1], stride, sums);
    std::copy_n(luma[0], width, luma_upper);
    std::copy_n(luma[1], width, luma_lower);
    return;
  }
  for (size_t x = 0; x < width; x += block) {
    const size_t at = std::min(x, width - block);
    DoBlock(upper + 3 * at, lower + 3 * at, luma_upper + at, luma_lower + at, stride, sums + at);
  }
}

// `sums` has space for a block after the last.
void ConvertChroma(const int16_t* sums, size_t stride, size_t width, uint8_t* cb, uint8_t* cr) {
  const size_t block = hn::Lanes(kInts);
  const auto four = [](const int16_t* at) {
    hn::Vec<Shorts> even, odd;
    hn::LoadInterleaved2(kShorts, at, even, odd);
    return hn::PromoteTo(kInts, hn::Add(even, odd));
  };
  const size_t samples = width / 2;
  for (size_t i = 0; i < samples; i += block) {
    const int16_t* at = sums + 2 * i;
    const Channels in = {four(at), four(at + stride), four(at + 2 * stride)};
    const size_t count = std::min(block, samples - i);
    uint8_t bytes[kMostLanes];
    hn::StoreU(Weigh<kChromaBits>(in, kCbR, kCbG, kCbB, kChromaOffset), kBytes, bytes);
    std::copy_n(bytes, count, cb + i);
    hn::StoreU(Weigh<kChromaBits>(in, kCrR, kCrG, kCrB, kChromaOffset), kBytes, bytes);
    std::copy_n(bytes, count, cr + i);
  }
}

void ConvertImage(int width, int height, const uint8_t* rgb, int16_t* sums, uint8_t* yuv) {
  const size_t w = static_cast<size_t>(width), h = static_cast<size_t>(height);
  const size_t stride = w + 2 * kMostLanes;
  uint8_t* cb = yuv + w * h;
  uint8_t* cr = cb + w * h / 4;
  for (size_t y = 0; y < h; y += 2) {
    const uint8_t* row = rgb + 3 * w * y;
    ConvertRows(row, row + 3 * w, w, yuv + w * y, yuv + w * (y + 1), stride, sums);
    ConvertChroma(sums, stride, w, cb + y / 2 * (w / 2), cr + y / 2 * (w / 2));
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {

HWY_EXPORT(ConvertImage);

Yuv420Converter::Yuv420Converter(int width, int height) : width_(width), height_(height) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0) {
    throw ArgumentError(
        fmt::format("YUV 4:2:0 needs an even width and height, not {}x{} px", width, height));
  }
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  yuv_.resize(pixels + pixels / 2);
  // Each channel: the row, and the numbers that a block reads after it.
  sums_.resize(3 * (static_cast<size_t>(width) + 32));
}

std::span<const uint8_t> Yuv420Converter::operator()(std::span<const uint8_t> rgb) {
  const size_t expected = 3 * static_cast<size_t>(width_) * static_cast<size_t>(height_);
  if (rgb.size() != expected) {
    throw ArgumentError(fmt::format("an RGB image of {}x{} px has {} bytes, not {}", width_,
                                    height_, expected, rgb.size()));
  }
  HWY_DYNAMIC_DISPATCH(ConvertImage)(width_, height_, rgb.data(), sums_.data(), yuv_.data());
  return yuv_;
}

}  // namespace robocell::internal
#endif
