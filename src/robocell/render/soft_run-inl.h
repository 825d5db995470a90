// Colours of runs: blocks beside each other that show nothing but one flat face, as of a floor;
// part of soft_kernel.cc, compiled for each instruction set. What changes smoothly over such a face
// is computed at the four outermost pixels of each block and lies between them elsewhere.
#if defined(ROBOCELL_SOFT_RUN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_RUN_INL_H_
#undef ROBOCELL_SOFT_RUN_INL_H_
#else
#define ROBOCELL_SOFT_RUN_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

// Shorter ones are not worth it.
constexpr int kShortestRun = 4;

// A number that changes over blocks, one block a lane.
struct Patch {
  V corner, right, down, across;

  // Interpolates from the values at the outermost pixels: first row, then last row.
  HWY_INLINE void Be(const V at[4]) {
    const V third = Num(1.0f / 3);
    const V upper = hn::Mul(third, hn::Sub(at[1], at[0])),
            lower = hn::Mul(third, hn::Sub(at[3], at[2]));
    corner = at[0];
    right = upper;
    down = hn::Mul(third, hn::Sub(at[2], at[0]));
    across = hn::Mul(third, hn::Sub(lower, upper));
  }
};

// Patches of up to kLanes blocks, as the blocks are coloured one after the other.
struct alignas(64) StoredPatch {
  float at[4][kSoftPixels];

  HWY_INLINE void Store(const Patch& p) {
    hn::Store(p.corner, kFloats, at[0]);
    hn::Store(p.right, kFloats, at[1]);
    hn::Store(p.down, kFloats, at[2]);
    hn::Store(p.across, kFloats, at[3]);
  }
  // The numbers in a part of block `i`.
  HWY_INLINE V Of(int i, int part) const {
    const V x = hn::Load(kFloats, kColumn + part), y = hn::Load(kFloats, kRow + part);
    return hn::Add(hn::Add(Num(at[0][i]), hn::Mul(Num(at[1][i]), x)),
                   hn::Mul(y, hn::Add(Num(at[2][i]), hn::Mul(Num(at[3][i]), x))));
  }
};

// Returns true if runs of the face may be coloured as such.
inline bool IsRunFace(const SoftPicture& picture, const SoftInstance& instance, int triangle) {
  if (picture.reflection || !instance.mesh->surface[triangle].flat) return false;
  const SoftMaterial& material = instance.material;
  if (material.mapping != SoftMapping::kNone && material.mapping != SoftMapping::kPlanar) {
    return false;
  }
  int shadowed = 0;
  for (int l = 0; l < picture.light_count; ++l) {
    if (!picture.lights[l].directional) return false;
    shadowed += picture.shadows && picture.lights[l].shadow;
  }
  return shadowed <= 1 && picture.light_count <= FaceLight::kMost;
}

// Part of a run: at most kLanes blocks.
class Run {
 public:
  HWY_INLINE Run(const SoftPicture& picture, const SoftInstance& instance, SoftFace* face)
      : picture_(picture), instance_(instance), face_(*face), gains_(GainsOf(picture, instance)) {
    for (int l = 0; l < picture.light_count; ++l) {
      if (picture.shadows && picture.lights[l].shadow) shadowed_ = l;
    }
    textured_ = instance.material.mapping == SoftMapping::kPlanar;
  }

  // Computes what the blocks from (bx, by) on show at their outermost pixels.
  HWY_INLINE void Begin(const SoftBuffer& buffer, int bx, int by, int count) {
    const SoftView& view = *picture_.view;
    const float* nearness =
        buffer
            .nearness[static_cast<size_t>(by) * static_cast<size_t>(buffer.columns) +
                      static_cast<size_t>(bx)]
            .at;
    // Lanes without a block show the last one.
    const I lane = hn::Min(hn::Iota(kInts, 0), hn::Set(kInts, count - 1));
    const V left = hn::ConvertTo(kFloats, hn::ShiftLeft<2>(hn::Add(lane, hn::Set(kInts, bx))));
    const I first = hn::ShiftLeft<4>(lane);
    V even[3][4], lit[3][4], u[4], v[4], map[3][4];
    M far = hn::Gt(left, left);
    shines_ = false;
    for (int k = 0; k < 4; ++k) {
      const int x = 3 * (k % 2), y = 3 * (k / 2);
      const V q = hn::GatherIndex(kFloats, nearness + kSoftBlock * y + x, first);
      const Pixels p = PixelsThrough(view, hn::Add(left, Num(static_cast<float>(x))),
                                     Num(static_cast<float>(kSoftBlock * by + y)), q);
      AddLight(p, k, even, lit);
      if (textured_) {
        const V3 at = InMesh(instance_.to_mesh, p.at);
        const SoftMaterial& material = instance_.material;
        u[k] = hn::Add(hn::Mul(Num(material.scale[0]), at.x), Num(material.offset[0]));
        v[k] = hn::Add(hn::Mul(Num(material.scale[1]), at.y), Num(material.offset[1]));
      }
      if (shadowed_ >= 0) {
        const V3 lifted = Add(p.at, Set3(lift_));
        const float* m = picture_.lights[shadowed_].shadow->to_map;
        for (int r = 0; r < 3; ++r) {
          map[r][k] = hn::Add(Dot(Set3(m + 4 * r), lifted), Num(m[4 * r + 3]));
        }
      }
      if (picture_.sky.texture) far = hn::Or(far, MayBeSky(picture_, p));
    }
    far_ = BitsOf(far);
    Patch patch;
    for (int c = 0; c < 3; ++c) {
      patch.Be(even[c]);
      even_[c].Store(patch);
      if (shadowed_ < 0) continue;
      patch.Be(lit[c]);
      lit_[c].Store(patch);
    }
    if (textured_) SetTexture(u, v);
    if (shadowed_ >= 0) SetShadow(map);
  }

  // Sets the lighting of the face; call it before Begin.
  void SetFace(int triangle) {
    face_.Be(picture_, instance_, triangle);
    if (shadowed_ < 0) return;
    const float facing = face_.light.facing[shadowed_];
    const float lift = LiftOf(*picture_.lights[shadowed_].shadow, facing);
    for (int k = 0; k < 3; ++k) lift_[k] = lift * face_.normal[k];
  }

  // Returns true if the sky may hide a part of the block: it is coloured pixel by pixel.
  HWY_INLINE bool IsFar(int i) const { return (far_ >> i & 1) != 0; }

  HWY_INLINE Colour Of(int i, int part) const {
    V sum[3];
    for (int c = 0; c < 3; ++c) {
      sum[c] = Clamp01(shines_ ? even_[c].Of(i, part) : Num(even_[c].at[0][i]));
    }
    if (shadowed_ >= 0 && !(dark_ >> i & 1)) {
      const bool whole = (bright_ >> i & 1) != 0;
      const V share = whole ? Num(1) : Share(i, part);
      for (int c = 0; c < 3; ++c) {
        V of_light = shines_ ? lit_[c].Of(i, part) : Num(lit_[c].at[0][i]);
        if (!whole) of_light = hn::Mul(share, of_light);
        sum[c] = hn::Add(sum[c], Clamp01(of_light));
      }
    }
    const Colour c{sum[0], sum[1], sum[2]};
    if (!textured_) return c;
    return Product(c, Sample(*instance_.material.texture, level_[i], rest_[i], u_.Of(i, part),
                             v_.Of(i, part)));
  }

 private:
  // The light at a place of each block: that which is there in any case, and that which a shadow
  // may take away.
  HWY_INLINE void AddLight(const Pixels& p, int k, V even[3][4], V lit[3][4]) {
    const SoftMaterial& material = instance_.material;
    for (int c = 0; c < 3; ++c) {
      even[c][k] = Num(face_.light.sum[c]);
      if (shadowed_ < 0) continue;
      const SoftGain& gain = gains_[shadowed_];
      const float diffuse = std::max(face_.light.facing[shadowed_], 0.0f);
      lit[c][k] = Num(gain.ambient[c] + diffuse * gain.diffuse[c]);
    }
    if (!material.shines) return;
    const V3 eye = EyeAt(picture_, p);
    const V along_eye = Dot(Set3(face_.normal), eye);
    for (int l = 0; l < picture_.light_count; ++l) {
      if (!gains_[l].shines || face_.light.facing[l] <= 0) continue;
      const V light_eye = Dot(Set3(picture_.lights[l].direction), eye);
      const V highlight = Highlight(material, Num(face_.light.facing[l]), along_eye, light_eye);
      shines_ |= !hn::AllFalse(kFloats, hn::Gt(highlight, hn::Zero(kFloats)));
      for (int c = 0; c < 3; ++c) {
        V& to = l == shadowed_ ? lit[c][k] : even[c][k];
        to = hn::Add(to, hn::Mul(highlight, Num(gains_[l].specular[c])));
      }
    }
  }

  HWY_INLINE void SetTexture(const V u[4], const V v[4]) {
    Patch patch;
    patch.Be(u);
    u_.Store(patch);
    const V ur = patch.right, ud = patch.down;
    patch.Be(v);
    v_.Store(patch);
    const SoftTexture& texture = *instance_.material.texture;
    const V w = Num(static_cast<float>(texture.width)), h = Num(static_cast<float>(texture.height));
    const V square = hn::Max(Square(hn::Mul(ur, w), hn::Mul(patch.right, h)),
                             Square(hn::Mul(ud, w), hn::Mul(patch.down, h)));
    const V lod = LevelOf(texture, square), whole = hn::Floor(lod);
    hn::Store(hn::ConvertTo(kInts, whole), kInts, level_);
    hn::Store(hn::Sub(lod, whole), kFloats, rest_);
  }

  // Most blocks are nearer to the light than all that the map shows around them, or farther.
  HWY_INLINE void SetShadow(const V map[3][4]) {
    Patch patch;
    V low[3], high[3];
    for (int r = 0; r < 3; ++r) {
      patch.Be(map[r]);
      map_[r].Store(patch);
      low[r] = hn::Min(hn::Min(map[r][0], map[r][1]), hn::Min(map[r][2], map[r][3]));
      high[r] = hn::Max(hn::Max(map[r][0], map[r][1]), hn::Max(map[r][2], map[r][3]));
    }
    const V one = Num(1);
    if (face_.light.facing[shadowed_] <= 0) {
      bright_ = ~0u;  // not that there were any
      dark_ = 0;
      return;
    }
    const SoftShadow& shadow = *picture_.lights[shadowed_].shadow;
    const V last = Num(static_cast<float>(shadow.view.width - 4));
    // Points outside the map are lit.
    const M outside = hn::Or(hn::Or(hn::Or(hn::Le(high[0], one), hn::Ge(low[0], last)),
                                    hn::Or(hn::Le(high[1], one), hn::Ge(low[1], last))),
                             hn::Ge(low[2], one));
    M inside = hn::And(hn::And(hn::And(hn::Gt(low[0], one), hn::Lt(high[0], last)),
                               hn::And(hn::Gt(low[1], one), hn::Lt(high[1], last))),
                       hn::Lt(high[2], one));
    // Two tiles on each side at most.
    const V side = Num(static_cast<float>(kSoftTile * kSoftBlock));
    inside = hn::And(inside, hn::And(hn::Lt(hn::Sub(high[0], low[0]), side),
                                     hn::Lt(hn::Sub(high[1], low[1]), side)));
    const SoftShadowMap& pixels = *shadow.map;
    V nearest = hn::Zero(kFloats), farthest = Num(3e38f);
    for (int k = 0; k < 4; ++k) {
      const auto tile = [&](V at) HWY_ATTR {
        return hn::ShiftRight<kSoftTileBits>(
            hn::ConvertTo(kInts, hn::Floor(hn::IfThenElseZero(inside, at))));
      };
      const I at =
          hn::Add(hn::Mul(tile(k / 2 ? high[1] : low[1]), hn::Set(kInts, pixels.tile_columns)),
                  tile(k % 2 ? high[0] : low[0]));
      nearest = hn::Max(nearest, hn::GatherIndex(kFloats, pixels.nearest.data(), at));
      farthest = hn::Min(farthest, hn::GatherIndex(kFloats, pixels.farthest.data(), at));
    }
    bright_ = BitsOf(hn::Or(outside, hn::And(inside, hn::Ge(low[2], nearest))));
    dark_ = BitsOf(hn::And(inside, hn::Lt(high[2], farthest)));
  }

  HWY_INLINE V Share(int i, int part) const {
    const V u = map_[0].Of(i, part), v = map_[1].Of(i, part), nearness = map_[2].Of(i, part);
    const SoftShadow& shadow = *picture_.lights[shadowed_].shadow;
    return LitAt(shadow, hn::Lt(nearness, Num(1)), u, v, nearness);
  }

  const SoftPicture& picture_;
  const SoftInstance& instance_;
  SoftFace& face_;
  const SoftGain* gains_;
  int shadowed_ = -1;  // the light that casts shadows
  bool textured_ = false, shines_ = false;
  float lift_[3] = {};
  uint32_t far_ = 0, bright_ = 0, dark_ = 0;
  StoredPatch even_[3], lit_[3], u_, v_, map_[3];
  alignas(64) int32_t level_[kSoftPixels];
  alignas(64) float rest_[kSoftPixels];
};

// Returns the number of blocks from `bx` on that show only the triangle `id`.
HWY_INLINE int RunLength(const SoftBuffer& buffer, size_t block, int bx, int32_t id) {
  const I one = hn::Set(kInts, id);
  int end = bx;
  for (; end < buffer.columns; ++end, ++block) {
    for (int part = 0; part < kSoftPixels; part += kLanes) {
      if (!hn::AllTrue(kInts, hn::Eq(LoadIds(buffer, block, part), one))) return end - bx;
    }
  }
  return end - bx;
}

// Colours a run and returns true, unless it is to be coloured block by block.
template <class PutBlock>
inline HWY_NOINLINE bool ShadeRun(const SoftPicture& picture, const SoftBuffer& buffer, int bx,
                                  int by, int count, SoftFace* face, const PutBlock& put) {
  const size_t start = static_cast<size_t>(by) * static_cast<size_t>(buffer.columns);
  const uint32_t id = buffer.ids[start + static_cast<size_t>(bx)].at[0];
  const SoftInstance& instance = picture.instances[picture.instance_of_run[id >> kSoftRunBits]];
  const auto triangle = static_cast<int>(id - instance.first_id);
  if (!IsRunFace(picture, instance, triangle)) return false;
  Run run(picture, instance, face);
  run.SetFace(triangle);
  alignas(64) int32_t pixels[kSoftPixels];
  for (int first = 0; first < count; first += kLanes) {
    const int here = std::min(kLanes, count - first);
    run.Begin(buffer, bx + first, by, here);
    for (int i = 0; i < here; ++i) {
      const int x = bx + first + i;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        Colour c;
        if (run.IsFar(i)) {
          const V nearness = LoadNearness(buffer, start + static_cast<size_t>(x), part);
          const Pixels p = PixelsAt(*picture.view, x, by, part, nearness);
          c = WithSky(picture, p, hn::FirstN(kFloats, 0),
                      ShadeOne(picture, instance, p, triangle, face));
        } else {
          c = run.Of(i, part);
        }
        hn::Store(PackPixels(c), kInts, pixels + part);
      }
      put(x, pixels);
    }
  }
  return true;
}

inline void ShadePictureHere(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                             SoftIds* colours, uint8_t* rgb) {
  SoftFace face, mirrored;
  alignas(64) int32_t pixels[kSoftPixels];
  const int width = picture.view->width, height = picture.view->height;
  for (int by = rows.begin; by < rows.end; ++by) {
    const size_t start = static_cast<size_t>(by) * static_cast<size_t>(buffer.columns);
    const auto put = [&](int bx, const int32_t* from) HWY_ATTR {
      if (rgb) {
        PutColours(from, bx, by, width, height, rgb);
      } else {
        std::copy_n(from, kSoftPixels,
                    reinterpret_cast<int32_t*>(colours[start + static_cast<size_t>(bx)].at));
      }
    };
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = start + static_cast<size_t>(bx);
      const auto id = static_cast<int32_t>(buffer.ids[block].at[0]);
      if (id >= 0) {
        const int run = RunLength(buffer, block, bx, id);
        if (run >= kShortestRun && ShadeRun(picture, buffer, bx, by, run, &face, put)) {
          bx += run - 1;
          continue;
        }
      }
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        const I ids = LoadIds(buffer, block, part);
        const V nearness = LoadNearness(buffer, block, part);
        const Pixels p = PixelsAt(*picture.view, bx, by, part, nearness);
        const M nothing = hn::RebindMask(kFloats, hn::Lt(ids, hn::Zero(kInts)));
        Colour c = ShadePixels(picture, p, ids, &face);
        if (picture.reflection) {
          c = WithReflection(picture, block, bx, by, part, ids, nearness, c, &mirrored);
        }
        c = WithSky(picture, p, nothing, c);
        hn::Store(PackPixels(c), kInts, pixels + part);
      }
      put(bx, pixels);
    }
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
