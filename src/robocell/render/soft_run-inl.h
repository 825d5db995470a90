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
#include <cstring>

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
  float at[4][kSoftPixels] = {};

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
    bright_ = dark_ = wide_ = 0;
    const V left = hn::ConvertTo(kFloats, hn::ShiftLeft<2>(hn::Add(lane, hn::Set(kInts, bx))));
    const I first = hn::ShiftLeft<4>(lane);
    V even[3][4], lit[3][4], u[4], v[4], map[3][4];
    M far = hn::Gt(left, left), shining = far;
    for (int k = 0; k < 4; ++k) {
      const int x = 3 * (k % 2), y = 3 * (k / 2);
      const V q = hn::GatherIndex(kFloats, nearness + kSoftBlock * y + x, first);
      const Pixels p = PixelsThrough(view, hn::Add(left, Num(static_cast<float>(x))),
                                     Num(static_cast<float>(kSoftBlock * by + y)), q);
      AddLight(p, k, even, lit, &shining);
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
    shining_ = BitsOf(shining);
    SetEven(even, lit);
  }

  // Sets the lighting of the face; call it before Begin.
  void SetFace(int triangle) {
    face_.Be(picture_, instance_, triangle);
    if (shadowed_ < 0) return;
    const float facing = face_.light.facing[shadowed_];
    const float lift = LiftOf(*picture_.lights[shadowed_].shadow, facing);
    for (int k = 0; k < 3; ++k) lift_[k] = lift * face_.normal[k];
    plane_ = PlaneInMap(*picture_.lights[shadowed_].shadow, face_.normal);
  }

  // Returns true if the sky may hide a part of the block: it is coloured pixel by pixel.
  HWY_INLINE bool IsFar(int i) const { return (far_ >> i & 1) != 0; }

  // Returns true if all pixels of the block have one colour.
  HWY_INLINE bool IsEven(int i) const { return (is_even_ >> i & 1) != 0; }
  HWY_INLINE I EvenColour(int i) const { return hn::Set(kInts, colour_[i]); }

  HWY_INLINE Colour Of(int i, int part) const {
    V sum[3];
    const bool shines = (shining_ >> i & 1) != 0;
    for (int c = 0; c < 3; ++c) {
      sum[c] = Clamp01(shines ? even_[c].Of(i, part) : Num(even_[c].at[0][i]));
    }
    if (shadowed_ >= 0 && !(dark_ >> i & 1)) {
      const bool whole = (bright_ >> i & 1) != 0;
      const V share = whole ? Num(1) : Share(i, part);
      for (int c = 0; c < 3; ++c) {
        V of_light = shines ? lit_[c].Of(i, part) : Num(lit_[c].at[0][i]);
        if (!whole) of_light = hn::Mul(share, of_light);
        sum[c] = hn::Add(sum[c], Clamp01(of_light));
      }
    }
    const Colour c{sum[0], sum[1], sum[2]};
    if (!textured_) return c;
    if (wide_ >> i & 1)
      return Product(c, {Num(texel_[0][i]), Num(texel_[1][i]), Num(texel_[2][i])});
    return Product(c, Sample(*instance_.material.texture, level_[i], rest_[i], u_.Of(i, part),
                             v_.Of(i, part)));
  }

 private:
  // The light at a place of each block: that which is there in any case, and that which a shadow
  // may take away.
  HWY_INLINE void AddLight(const Pixels& p, int k, V even[3][4], V lit[3][4], M* shining) {
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
      *shining = hn::Or(*shining, hn::Gt(highlight, hn::Zero(kFloats)));
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
    const V lod = LevelOf(texture, square), whole = hn::Floor(lod), rest = hn::Sub(lod, whole);
    const I level = hn::ConvertTo(kInts, whole);
    hn::Store(level, kInts, level_);
    hn::Store(rest, kFloats, rest_);
    // Whole blocks often show one colour of the texture, as most of a checker does.
    const auto range = [](const V at[4]) HWY_ATTR {
      return PlaceRange{hn::Min(hn::Min(at[0], at[1]), hn::Min(at[2], at[3])),
                        hn::Max(hn::Max(at[0], at[1]), hn::Max(at[2], at[3]))};
    };
    const PlaceRange us = range(u), vs = range(v);
    I texel, next_texel;
    M wide = FindWide(texture, level, us, vs, &texel);
    if (hn::AllFalse(kFloats, wide)) return;
    const I next = hn::Min(hn::Add(level, hn::Set(kInts, 1)), hn::Set(kInts, texture.levels - 1));
    const M between = hn::Gt(rest, hn::Zero(kFloats));
    wide = hn::And(wide, hn::Or(hn::Not(between), FindWide(texture, next, us, vs, &next_texel)));
    const Colour one = Unpack(texel), mixed = Mix(one, Unpack(next_texel), rest);
    const Colour c =
        Share255({hn::IfThenElse(between, mixed.r, one.r), hn::IfThenElse(between, mixed.g, one.g),
                  hn::IfThenElse(between, mixed.b, one.b)});
    wide_ = BitsOf(wide);
    hn::Store(c.r, kFloats, texel_[0]);
    hn::Store(c.g, kFloats, texel_[1]);
    hn::Store(c.b, kFloats, texel_[2]);
  }

  // Finds the blocks of one colour and computes it: the same bits as `Of`.
  HWY_INLINE void SetEven(const V even[3][4], const V lit[3][4]) {
    uint32_t is_even = ~(shining_ | far_);
    if (shadowed_ >= 0) is_even &= bright_ | dark_;
    if (textured_) is_even &= wide_;
    is_even_ = is_even & ((1u << kLanes) - 1);
    if (is_even_ == 0) return;
    V sum[3];
    alignas(64) int32_t shown[kSoftPixels];
    for (int l = 0; l < kLanes; ++l) shown[l] = -static_cast<int32_t>(~dark_ >> l & 1);
    const M reached = hn::RebindMask(kFloats, hn::Lt(hn::Load(kInts, shown), hn::Zero(kInts)));
    for (int c = 0; c < 3; ++c) {
      sum[c] = Clamp01(even[c][0]);
      if (shadowed_ >= 0) {
        sum[c] = hn::IfThenElse(reached, hn::Add(sum[c], Clamp01(lit[c][0])), sum[c]);
      }
      if (textured_) sum[c] = hn::Mul(sum[c], hn::Load(kFloats, texel_[c]));
    }
    hn::Store(PackPixels({sum[0], sum[1], sum[2]}), kInts, colour_);
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
    const SoftShadowMap& pixels = *shadow.map;
    const V last = Num(static_cast<float>(shadow.view.width - 4));
    // Points outside the map are lit.
    const M outside = hn::Or(hn::Or(hn::Or(hn::Le(high[0], one), hn::Ge(low[0], last)),
                                    hn::Or(hn::Le(high[1], one), hn::Ge(low[1], last))),
                             hn::Ge(low[2], one));
    M inside = hn::And(hn::And(hn::And(hn::Gt(low[0], one), hn::Lt(high[0], last)),
                               hn::And(hn::Gt(low[1], one), hn::Lt(high[1], last))),
                       hn::Lt(high[2], one));
    // The level at which a block meets two tiles on each side at most.
    const V extent = hn::Max(hn::Sub(high[0], low[0]), hn::Sub(high[1], low[1]));
    I level = hn::Zero(kInts), columns = hn::Set(kInts, pixels.level_columns[0]), start = level;
    const auto side = [](int of_level) {
      return Num(static_cast<float>(kSoftTile * kSoftBlock << of_level));
    };
    for (int k = 1; k < kSoftTileLevels; ++k) {
      const auto larger = hn::RebindMask(kInts, hn::Ge(extent, side(k - 1)));
      level = hn::IfThenElse(larger, hn::Set(kInts, k), level);
      columns = hn::IfThenElse(larger, hn::Set(kInts, pixels.level_columns[k]), columns);
      start = hn::IfThenElse(larger, hn::Set(kInts, pixels.level_start[k]), start);
    }
    inside = hn::And(inside, hn::Lt(extent, side(kSoftTileLevels - 1)));
    V nearest = hn::Zero(kFloats), farthest = Num(3e38f);
    for (int k = 0; k < 4; ++k) {
      const auto tile = [&](V at) HWY_ATTR {
        return hn::Shr(hn::ConvertTo(kInts, hn::Floor(hn::IfThenElseZero(inside, at))),
                       hn::Add(level, hn::Set(kInts, kSoftTileBits)));
      };
      const I at = hn::Add(start, hn::Add(hn::Mul(tile(k / 2 ? high[1] : low[1]), columns),
                                          tile(k % 2 ? high[0] : low[0])));
      nearest = hn::Max(nearest, hn::GatherIndex(kFloats, pixels.nearest.data(), at));
      farthest = hn::Min(farthest, hn::GatherIndex(kFloats, pixels.farthest.data(), at));
    }
    M bright = hn::Or(outside, hn::And(inside, hn::Ge(low[2], nearest))),
      dark = hn::And(inside, hn::Lt(high[2], farthest));
    if (!hn::AllTrue(kFloats, hn::Or(bright, dark))) SetShadowNear(map, low, high, &bright, &dark);
    bright_ = BitsOf(bright);
    dark_ = BitsOf(dark);
  }

  // The same for blocks that meet two pixels of the map on each side at most: compares the face with
  // the 4 x 4 pixels that its points read.
  HWY_INLINE void SetShadowNear(const V map[3][4], const V low[3], const V high[3], M* bright,
                                M* dark) const {
    const SoftShadow& shadow = *picture_.lights[shadowed_].shadow;
    const V margin = Num(1e-3f), last = Num(static_cast<float>(shadow.view.width - 5));
    const V column = hn::Floor(hn::Sub(low[0], margin)), row = hn::Floor(hn::Sub(low[1], margin));
    const V beyond_column = hn::Add(column, Num(2)), beyond_row = hn::Add(row, Num(2));
    M near = hn::And(hn::Lt(hn::Add(high[0], margin), beyond_column),
                     hn::Lt(hn::Add(high[1], margin), beyond_row));
    near = hn::And(near, hn::And(hn::And(hn::Gt(column, Num(1)), hn::Lt(column, last)),
                                 hn::And(hn::Gt(row, Num(1)), hn::Lt(row, last))));
    near = hn::And(near, hn::And(hn::Lt(high[2], Num(1)), hn::Not(hn::Or(*bright, *dark))));
    if (hn::AllFalse(kFloats, near)) return;
    const PlaneInMap& plane = plane_;
    V least = hn::Sub(map[2][0], plane.At(map[0][0], map[1][0])), most = least;
    for (int k = 1; k < 4; ++k) {
      const V height = hn::Sub(map[2][k], plane.At(map[0][k], map[1][k]));
      least = hn::Min(least, height);
      most = hn::Max(most, height);
    }
    const SoftBuffer& pixels = shadow.map->buffer;
    const I three = hn::Set(kInts, 3), stride = hn::Set(kInts, pixels.columns);
    V nearest = Num(-3e38f), farthest = Num(3e38f);
    for (int k = 0; k < kSoftPixels; ++k) {
      const V u = hn::Add(column, Num(kColumn[k])), v = hn::Add(row, Num(kRow[k]));
      const I c = hn::ConvertTo(kInts, hn::IfThenElseZero(near, u)),
              r = hn::ConvertTo(kInts, hn::IfThenElseZero(near, v));
      const I block = hn::Add(hn::Mul(hn::ShiftRight<2>(r), stride), hn::ShiftRight<2>(c));
      const I pixel = hn::Add(hn::ShiftLeft<2>(hn::And(r, three)), hn::And(c, three));
      const V q =
          hn::GatherIndex(kFloats, pixels.nearness[0].at, hn::Add(hn::ShiftLeft<4>(block), pixel));
      const V height = hn::Sub(q, plane.At(u, v));
      nearest = hn::Max(nearest, height);
      farthest = hn::Min(farthest, height);
    }
    const M lit = hn::Ge(least, hn::Add(nearest, Num(plane.most()))),
            hidden = hn::Lt(most, hn::Add(farthest, Num(plane.least())));
    *bright = hn::Or(*bright, hn::And(near, lit));
    *dark = hn::Or(*dark, hn::And(near, hidden));
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
  bool textured_ = false;
  float lift_[3] = {};
  PlaneInMap plane_;  // the face
  // Bits of the blocks.
  uint32_t far_ = 0, bright_ = 0, dark_ = 0, shining_ = 0, wide_ = 0, is_even_ = 0;
  StoredPatch even_[3], lit_[3], u_, v_, map_[3];
  alignas(64) int32_t level_[kSoftPixels] = {};
  alignas(64) float rest_[kSoftPixels] = {};
  alignas(64) float texel_[3][kSoftPixels] = {};
  alignas(64) int32_t colour_[kSoftPixels] = {};
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
      if (run.IsEven(i)) {
        const I colour = run.EvenColour(i);
        for (int part = 0; part < kSoftPixels; part += kLanes)
          hn::Store(colour, kInts, pixels + part);
        put(x, pixels);
        continue;
      }
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

// The same for those blocks of a run that have a flag, if there are flags: each block's colours are
// the same in any part of its run.
template <class PutBlock>
HWY_INLINE bool ShadeWanted(const SoftPicture& picture, const SoftBuffer& buffer, int bx, int by,
                            int count, const uint8_t* in_row, SoftFace* face, const PutBlock& put) {
  if (!in_row) return ShadeRun(picture, buffer, bx, by, count, face, put);
  for (int begin = bx; begin < bx + count; ++begin) {
    if (!in_row[begin]) continue;
    int end = begin + 1;
    while (end < bx + count && in_row[end]) ++end;
    if (!ShadeRun(picture, buffer, begin, by, end - begin, face, put)) return false;
    begin = end;
  }
  return true;
}

// `wanted`: null, or a flag of each block; the colours of the others stay as they are.
inline void ShadePictureHere(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                             const uint8_t* wanted, SoftIds* colours, uint8_t* rgb) {
  SoftFace face, mirrored;
  alignas(64) int32_t pixels[kSoftPixels];
  const int width = picture.view->width, height = picture.view->height;
  for (int by = rows.begin; by < rows.end; ++by) {
    const size_t start = static_cast<size_t>(by) * static_cast<size_t>(buffer.columns);
    const uint8_t* in_row = wanted ? wanted + start : nullptr;
    if (in_row && !std::memchr(in_row, 1, static_cast<size_t>(buffer.columns))) continue;
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
        if (run >= kShortestRun && ShadeWanted(picture, buffer, bx, by, run, in_row, &face, put)) {
          bx += run - 1;
          continue;
        }
      }
      if (in_row && !in_row[bx]) continue;
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
