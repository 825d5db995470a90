// Blocks of 4x4 pixels in vector registers: a triangle's edges in one of them, and what is nearest.
// Part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_BLOCKS_INL_H_
#undef ROBOCELL_SOFT_BLOCKS_INL_H_
#else
#define ROBOCELL_SOFT_BLOCKS_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "robocell/render/soft_frame.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Registers of up to 16 pixels or triangles.
using Floats = hn::CappedTag<float, kSoftPixels>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using M = hn::Mask<Floats>;
constexpr Floats kFloats;
constexpr Ints kInts;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kFloats));

alignas(64) constexpr float kColumn[kSoftPixels] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr float kRow[kSoftPixels] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

// Rounded corners farther from the upper left pixel than this are clipped: edge functions of the
// others are exact.
constexpr float kReach = 1 << 20;
// The mark of a corner that must be clipped, and of one behind the camera's near plane.
constexpr float kBeyond = 4e9f, kBehind = -1;
// Triangles of at most this many steps on each side have exact edge functions in single precision:
// 10 pixels of 256 steps, 2 blocks and a rest.
constexpr float kSmall = 2560;
// Those of at most this many pixels on each side have exact ones in 32 bits.
constexpr float kMiddling = 28;

HWY_INLINE V Num(float value) { return hn::Set(kFloats, value); }

// One block and one triangle. Edge functions are those at the block's first pixel, then their steps
// to the right and down.
struct BlockEdges {
  float e[3], right[3], down[3];
};

HWY_INLINE M Inside(const BlockEdges& t, int part, V* e1, V* e2) {
  const V x = hn::Load(kFloats, kColumn + part), y = hn::Load(kFloats, kRow + part);
  const auto edge = [&](int k) HWY_ATTR {
    return hn::Add(Num(t.e[k]), hn::Add(hn::Mul(Num(t.right[k]), x), hn::Mul(Num(t.down[k]), y)));
  };
  *e1 = edge(1);
  *e2 = edge(2);
  return hn::Ge(hn::Min(edge(0), hn::Min(*e1, *e2)), hn::Zero(kFloats));
}

// Stores whole registers: the next triangle often meets the same block, and a processor hands on
// only what was stored whole.
template <bool kIds>
HWY_INLINE void Put(M covered, V nearness, uint32_t id, int part, float* at, uint32_t* ids) {
  const V before = hn::Load(kFloats, at + part);
  const M mask = hn::And(covered, hn::Ge(nearness, before));
  hn::Store(hn::IfThenElse(mask, nearness, before), kFloats, at + part);
  if constexpr (kIds) {
    auto* to = reinterpret_cast<int32_t*>(ids) + part;
    const I ids_before = hn::Load(kInts, to);
    hn::Store(hn::IfThenElse(hn::RebindMask(kInts, mask), hn::Set(kInts, static_cast<int32_t>(id)),
                             ids_before),
              kInts, to);
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
