// Colours of what is seen; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_SHADE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_SHADE_INL_H_
#undef ROBOCELL_SOFT_SHADE_INL_H_
#else
#define ROBOCELL_SOFT_SHADE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_light-inl.h"
#include "robocell/render/soft_texture-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

struct Pixels {
  V3 ray;  // in view axes, to depth 1; of orthographic cameras the offset on the image, and -1
  V depth;
  V3 at;  // view axes
};

// Through points that are this far from the pixels' centres.
HWY_INLINE Pixels PixelsAt(const SoftView& view, int bx, int by, int part, V nearness,
                           float right = 0, float down = 0) {
  const V u = hn::Add(Num(static_cast<float>(4 * bx)), hn::Load(kFloats, kColumn + part)),
          v = hn::Add(Num(static_cast<float>(4 * by)), hn::Load(kFloats, kRow + part));
  const V x = hn::Mul(hn::Sub(u, Num(view.cx - right)), Num(1 / view.fx)),
          y = hn::Mul(hn::Sub(Num(view.cy - down), v), Num(1 / view.fy));
  Pixels p{{x, y, Num(-1)}, Num(1), {}};
  if (view.orthographic) {
    p.depth = hn::Sub(Num(view.far), hn::Mul(nearness, Num(view.far - view.near)));
    p.at = {x, y, hn::Neg(p.depth)};
  } else {
    p.depth = hn::Div(Num(1), hn::Max(nearness, Num(1e-30f)));
    p.at = Times(p.depth, p.ray);
  }
  return p;
}

// Changes of a position on a plane of this normal from pixel to pixel, in the mesh's axes.
HWY_INLINE void Changes(const SoftView& view, const float* m, const Pixels& p, const V3& normal,
                        V3* right, V3* down) {
  const V3 across = Times(Num(1 / view.fx), V3{Num(m[0]), Num(m[4]), Num(m[8])});
  const V3 along = Times(Num(-1 / view.fy), V3{Num(m[1]), Num(m[5]), Num(m[9])});
  V3 ray = V3{Num(-m[2]), Num(-m[6]), Num(-m[10])};
  if (!view.orthographic) ray = Turned(m, 4, p.ray);
  const V facing = Dot(normal, ray);
  const V steep = hn::Div(Num(1), hn::CopySign(hn::Max(hn::Abs(facing), Num(1e-20f)), facing));
  const auto change = [&](const V3& step) HWY_ATTR {
    return Times(view.orthographic ? Num(1) : p.depth,
                 Sub(step, Times(hn::Mul(Dot(normal, step), steep), ray)));
  };
  *right = change(across);
  *down = change(along);
}

HWY_INLINE V Square(V u, V v) { return hn::Add(hn::Mul(u, u), hn::Mul(v, v)); }

// The normal of a flat triangle in view axes: to the bit what the general way gives.
HWY_INLINE void FlatNormal(const float* m, const SoftSurface& surface, float* normal) {
  const auto part = [&](int k) {
    return static_cast<float>(static_cast<int16_t>(surface.normals[k / 2] >> (16 * (k % 2))));
  };
  const float n[3] = {part(0), part(1), part(2)};
  for (int k = 0; k < 3; ++k) normal[k] = (n[0] * m[k] + n[1] * m[4 + k]) + n[2] * m[8 + k];
  const float length2 = (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
  const float scale = 1 / std::sqrt(std::max(length2, 1e-30f));
  for (int k = 0; k < 3; ++k) normal[k] = scale * normal[k];
}

// kOne: all pixels show triangle `one`; otherwise `triangle` says which.
template <bool kOne>
HWY_INLINE Colour ShadeInstance(const SoftPicture& picture, const SoftInstance& instance,
                                const Pixels& p, int one, I triangle) {
  const SoftMesh& mesh = *instance.mesh;
  const SoftSurface& only = mesh.surface[kOne ? one : 0];
  const auto* words = reinterpret_cast<const int32_t*>(mesh.surface.data());
  const I index = hn::ShiftLeft<4>(triangle);
  static_assert(sizeof(SoftSurface) == 64);
  const auto word = [&](int k) HWY_ATTR {
    if constexpr (kOne) {
      return hn::Set(kInts, words[16 * one + k]);
    } else {
      return hn::GatherIndex(kInts, words + k, index);
    }
  };
  const auto number = [&](int k) HWY_ATTR { return hn::BitCast(kFloats, word(k)); };
  const float* m = instance.to_mesh;
  V3 at = Turned(m, 4, p.at);
  at = {hn::Add(at.x, Num(m[3])), hn::Add(at.y, Num(m[7])), hn::Add(at.z, Num(m[11]))};
  const V3 to1 = {number(0), number(1), number(2)}, to2 = {number(4), number(5), number(6)};
  const V w1 = Clamp01(hn::Sub(Dot(at, to1), number(3))),
          w2 = Clamp01(hn::Sub(Dot(at, to2), number(7)));
  V3 normal;
  if (kOne && only.flat) {
    float flat[3];
    FlatNormal(m, only, flat);
    normal = Set3(flat);
  } else {
    V n[10];
    for (int k = 0; k < 5; ++k) {
      const I both = word(8 + k);
      n[2 * k] = hn::ConvertTo(kFloats, hn::ShiftRight<16>(hn::ShiftLeft<16>(both)));
      n[2 * k + 1] = hn::ConvertTo(kFloats, hn::ShiftRight<16>(both));
    }
    const auto between = [&](int k) HWY_ATTR {
      return hn::Add(n[k], hn::Add(hn::Mul(w1, hn::Sub(n[3 + k], n[k])),
                                   hn::Mul(w2, hn::Sub(n[6 + k], n[k]))));
    };
    normal = Unit(TurnedBack(m, 4, {between(0), between(1), between(2)}));
  }
  const SoftMaterial& material = instance.material;
  Colour c = Light(picture, material, p.at, normal);
  if (material.mapping == SoftMapping::kNone) return c;

  const SoftTexture& texture = *material.texture;
  V3 right, down;
  Changes(*picture.view, m, p, Cross(to1, to2), &right, &down);
  Colour texel;
  if (material.mapping == SoftMapping::kCube) {
    const V3 scale = Set3(material.scale);
    const auto scaled = [&](const V3& v) HWY_ATTR {
      return V3{hn::Mul(v.x, scale.x), hn::Mul(v.y, scale.y), hn::Mul(v.z, scale.z)};
    };
    const V3 r = scaled(right), d = scaled(down);
    texel = SampleCube(texture, scaled(at), hn::Max(Dot(r, r), Dot(d, d)));
  } else {
    V u, v, ur, vr, ud, vd;
    if (material.mapping == SoftMapping::kPlanar) {
      const V su = Num(material.scale[0]), sv = Num(material.scale[1]);
      u = hn::Add(hn::Mul(su, at.x), Num(material.offset[0]));
      v = hn::Add(hn::Mul(sv, at.y), Num(material.offset[1]));
      ur = hn::Mul(su, right.x);
      vr = hn::Mul(sv, right.y);
      ud = hn::Mul(su, down.x);
      vd = hn::Mul(sv, down.y);
    } else {
      const float* coordinates = mesh.texture.data();
      const I place = hn::Mul(triangle, hn::Set(kInts, SoftMesh::kTexture));
      const auto coordinate = [&](int k) HWY_ATTR {
        if constexpr (kOne) {
          return Num(coordinates[SoftMesh::kTexture * one + k]);
        } else {
          return hn::GatherIndex(kFloats, coordinates + k, place);
        }
      };
      const V u1 = coordinate(2), v1 = coordinate(3), u2 = coordinate(4), v2 = coordinate(5);
      const auto mix = [&](V a, V b, V first, V second)
                           HWY_ATTR { return hn::Add(hn::Mul(a, first), hn::Mul(b, second)); };
      u = hn::Add(coordinate(0), mix(w1, w2, u1, u2));
      v = hn::Add(coordinate(1), mix(w1, w2, v1, v2));
      const V r1 = Dot(to1, right), r2 = Dot(to2, right), d1 = Dot(to1, down), d2 = Dot(to2, down);
      ur = mix(r1, r2, u1, u2);
      vr = mix(r1, r2, v1, v2);
      ud = mix(d1, d2, u1, u2);
      vd = mix(d1, d2, v1, v2);
    }
    const V w = Num(static_cast<float>(texture.width)), h = Num(static_cast<float>(texture.height));
    const V square =
        hn::Max(Square(hn::Mul(ur, w), hn::Mul(vr, h)), Square(hn::Mul(ud, w), hn::Mul(vd, h)));
    texel = Sample(texture, hn::Zero(kInts), u, v, square);
  }
  return {hn::Mul(c.r, texel.r), hn::Mul(c.g, texel.g), hn::Mul(c.b, texel.b)};
}

// ---- Sky

HWY_INLINE Colour SkyColour(const SoftPicture& picture, const V3& in_world) {
  if (!picture.sky.texture) {
    const V zero = hn::Zero(kFloats);
    return {zero, zero, zero};
  }
  // A pixel's change of direction, at the centre of the image.
  const float step = picture.view->orthographic ? 0 : 1 / picture.view->fx;
  // The texture's y axis is up.
  return SampleCube(*picture.sky.texture, {in_world.x, in_world.z, hn::Neg(in_world.y)},
                    Num(step * step));
}

// Sky and haze hide what is beyond them. `nothing`: pixels that show no surface.
HWY_INLINE Colour WithSky(const SoftPicture& picture, const Pixels& p, M nothing, Colour c) {
  const SoftSky& sky = picture.sky;
  if (!sky.texture) {
    const V zero = hn::Zero(kFloats);
    return {hn::IfThenElse(nothing, zero, c.r), hn::IfThenElse(nothing, zero, c.g),
            hn::IfThenElse(nothing, zero, c.b)};
  }
  const V3 ray =
      picture.view->orthographic ? V3{hn::Zero(kFloats), hn::Zero(kFloats), Num(-1)} : p.ray;
  // Nothing that is near enough is hidden.
  const float haze_begins = sky.elevation > 0 ? 1 - sky.haze : 1;
  const V within = Num(0.7f * haze_begins * sky.radius);
  const V length2 = hn::Mul(hn::Mul(p.depth, p.depth), Dot(ray, ray));
  const M may_be = hn::Or(nothing, hn::Gt(length2, hn::Mul(within, within)));
  if (hn::AllFalse(kFloats, may_be)) return c;

  const V3 in_world = Turned(sky.from_view, 3, ray);
  const V flat = hn::Sqrt(Square(in_world.x, in_world.y));
  const V extent = hn::Max(hn::Max(flat, hn::Abs(in_world.z)), Num(1e-20f));
  const M behind = hn::Or(nothing, hn::Gt(hn::Mul(p.depth, extent), Num(sky.radius)));
  if (!hn::AllFalse(kFloats, behind)) {
    const Colour s = SkyColour(picture, in_world);
    c = {hn::IfThenElse(behind, s.r, c.r), hn::IfThenElse(behind, s.g, c.g),
         hn::IfThenElse(behind, s.b, c.b)};
  }
  if (sky.elevation <= 0) return c;

  // The haze is a cone that rises from the plane to the height of the camera at the sky.
  const V3 to = Turned(sky.to_plane, 3, ray);
  const V zero = hn::Zero(kFloats), one = Num(1), r = Num(sky.haze);
  const V along = hn::Max(hn::Sqrt(Square(to.x, to.y)), Num(1e-20f));
  const V slope = hn::Div(to.z, along);
  const V below =
      hn::Div(hn::Neg(slope),
              hn::Max(hn::Sub(Num(sky.elevation / sky.radius), hn::Mul(slope, r)), Num(1e-20f)));
  const V height = hn::Sub(one, below);
  const V distance = hn::Mul(Num(sky.radius), hn::Sub(one, hn::Mul(r, below)));
  const M hazy = hn::And(hn::And(hn::Ge(below, zero), hn::Le(below, one)),
                         hn::Or(behind, hn::Gt(hn::Mul(p.depth, along), distance)));
  const V densest = Num(sky.haze_height);
  const V rising = hn::Div(height, densest),
          falling = hn::Div(hn::Sub(one, height), hn::Sub(one, densest));
  const V alpha = hn::IfThenElseZero(hazy, Clamp01(hn::Min(rising, falling)));
  return Mix(c, {Num(sky.haze_rgb[0]), Num(sky.haze_rgb[1]), Num(sky.haze_rgb[2])}, alpha);
}

// ---- Blocks

HWY_INLINE I PackPixels(const Colour& c) {
  const V scale = Num(255);
  const auto byte = [&](V v) HWY_ATTR { return hn::NearestInt(hn::Mul(Clamp01(v), scale)); };
  return hn::Or(byte(c.r), hn::Or(hn::ShiftLeft<8>(byte(c.g)), hn::ShiftLeft<16>(byte(c.b))));
}

// Colours of a register of pixels; black where nothing is.
HWY_INLINE Colour ShadePixels(const SoftPicture& picture, const Pixels& p, I ids) {
  const V zero = hn::Zero(kFloats);
  Colour c{zero, zero, zero};
  alignas(64) int32_t all[kSoftPixels];
  hn::Store(ids, kInts, all);
  for (int k = 0; k < kLanes; ++k) {
    if (all[k] < 0) continue;
    const SoftInstance& instance =
        picture.instances[picture.instance_of_run[all[k] >> kSoftRunBits]];
    const auto first = static_cast<int32_t>(instance.first_id);
    const I one = hn::Set(kInts, all[k]);
    if (hn::AllTrue(kInts, hn::Eq(ids, one))) {
      return ShadeInstance<true>(picture, instance, p, all[k] - first, one);
    }
    const I triangle = hn::Sub(ids, hn::Set(kInts, first));
    const auto of_this = hn::And(hn::Gt(triangle, hn::Set(kInts, -1)),
                                 hn::Lt(triangle, hn::Set(kInts, instance.mesh->triangles)));
    const Colour here =
        ShadeInstance<false>(picture, instance, p, 0, hn::IfThenElseZero(of_this, triangle));
    const M mask = hn::RebindMask(kFloats, of_this);
    c = {hn::IfThenElse(mask, here.r, c.r), hn::IfThenElse(mask, here.g, c.g),
         hn::IfThenElse(mask, here.b, c.b)};
    for (int later = k; later < kLanes; ++later) {  // done
      const int32_t offset = all[later] - first;
      if (offset >= 0 && offset < instance.mesh->triangles) all[later] = -1;
    }
  }
  return c;
}

HWY_INLINE I LoadIds(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kInts, reinterpret_cast<const int32_t*>(buffer.ids[block].at) + part);
}
HWY_INLINE V LoadNearness(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kFloats, buffer.nearness[block].at + part);
}

// Adds what a mirror shows, in front of which nothing is.
HWY_INLINE Colour WithReflection(const SoftPicture& picture, size_t block, int bx, int by, int part,
                                 I ids, V nearness, const Colour& c) {
  const SoftReflection& r = *picture.reflection;
  const I triangle = hn::Sub(ids, hn::Set(kInts, static_cast<int32_t>(r.first_id)));
  const auto on_face =
      hn::And(hn::Gt(triangle, hn::Set(kInts, -1)), hn::Lt(triangle, hn::Set(kInts, r.triangles)));
  if (hn::AllFalse(kInts, on_face)) return c;
  // Mirrored, what is in front of the face lies behind it.
  const V near = LoadNearness(r.buffer, block, part);
  const auto shown =
      hn::And(on_face, hn::RebindMask(kInts, hn::Le(near, hn::Mul(nearness, Num(1.0001f)))));
  const I other = hn::IfThenElse(shown, LoadIds(r.buffer, block, part), hn::Set(kInts, -1));
  if (hn::AllFalse(kInts, hn::Gt(other, hn::Set(kInts, -1)))) return c;
  const Colour of_mirror =
      ShadePixels(r.picture, PixelsAt(*picture.view, bx, by, part, near), other);
  return {hn::Add(c.r, of_mirror.r), hn::Add(c.g, of_mirror.g), hn::Add(c.b, of_mirror.b)};
}

// The mean over the samples of pixels whose centres have colour `c`. A sample of the same surface
// has that colour too: edges are smoothed, textures and highlights are not.
HWY_INLINE Colour WithSamples(const SoftPicture& picture, std::span<const SoftSample> samples,
                              size_t block, int bx, int by, int part, I ids, V nearness,
                              const Colour& c) {
  const V zero = hn::Zero(kFloats);
  const V close = hn::Mul(Num(0.02f), nearness);
  const I run = hn::ShiftRight<kSoftRunBits>(ids);
  Colour sum{zero, zero, zero};
  bool edge = false;
  for (const SoftSample& sample : samples) {
    const I at = LoadIds(sample.buffer, block, part);
    const V near = LoadNearness(sample.buffer, block, part);
    const M same = hn::And(hn::RebindMask(kFloats, hn::Eq(run, hn::ShiftRight<kSoftRunBits>(at))),
                           hn::Le(hn::Abs(hn::Sub(near, nearness)), close));
    Colour here = c;
    if (!hn::AllTrue(kFloats, same)) {
      edge = true;
      const Pixels p = PixelsAt(*picture.view, bx, by, part, near, sample.right, sample.down);
      const I other = hn::IfThenElse(hn::RebindMask(kInts, same), hn::Set(kInts, -1), at);
      const M nothing = hn::RebindMask(kFloats, hn::Lt(other, hn::Zero(kInts)));
      const Colour shaded = WithSky(picture, p, nothing, ShadePixels(picture, p, other));
      here = {hn::IfThenElse(same, c.r, Clamp01(shaded.r)),
              hn::IfThenElse(same, c.g, Clamp01(shaded.g)),
              hn::IfThenElse(same, c.b, Clamp01(shaded.b))};
    }
    sum = {hn::Add(sum.r, here.r), hn::Add(sum.g, here.g), hn::Add(sum.b, here.b)};
  }
  if (!edge) return c;
  const V share = Num(1 / static_cast<float>(samples.size()));
  return {hn::Mul(share, sum.r), hn::Mul(share, sum.g), hn::Mul(share, sum.b)};
}

// A block's pixels as 3 bytes each to their place in an image of rows.
HWY_INLINE void PutColours(const int32_t* pixels, int bx, int by, int width, int height,
                           uint8_t* rgb) {
  const int rows = std::min(kSoftBlock, height - kSoftBlock * by);
  const int columns = std::min(kSoftBlock, width - kSoftBlock * bx);
  uint8_t* to = rgb + 3 * (static_cast<size_t>(kSoftBlock * by) * width + kSoftBlock * bx);
  for (int r = 0; r < rows; ++r, to += 3 * width) {
    uint32_t c[kSoftBlock];
    std::memcpy(c, pixels + kSoftBlock * r, sizeof c);
    const uint32_t words[3] = {c[0] | c[1] << 24, c[1] >> 8 | c[2] << 16, c[2] >> 16 | c[3] << 8};
    if (columns == kSoftBlock) {
      std::memcpy(to, words, sizeof words);
    } else {
      std::memcpy(to, words, static_cast<size_t>(3 * columns));
    }
  }
}

inline void ShadePictureHere(const SoftPicture& picture, const SoftBuffer& buffer,
                             std::span<const SoftSample> samples, SoftIds* colours, uint8_t* rgb) {
  alignas(64) int32_t pixels[kSoftPixels];
  for (int by = 0; by < buffer.rows; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        const I ids = LoadIds(buffer, block, part);
        const V nearness = LoadNearness(buffer, block, part);
        const Pixels p = PixelsAt(*picture.view, bx, by, part, nearness);
        const M nothing = hn::RebindMask(kFloats, hn::Lt(ids, hn::Zero(kInts)));
        Colour c = ShadePixels(picture, p, ids);
        if (picture.reflection) {
          c = WithReflection(picture, block, bx, by, part, ids, nearness, c);
        }
        c = WithSky(picture, p, nothing, c);
        c = {Clamp01(c.r), Clamp01(c.g), Clamp01(c.b)};
        if (!samples.empty()) {
          c = WithSamples(picture, samples, block, bx, by, part, ids, nearness, c);
        }
        hn::Store(PackPixels(c), kInts, pixels + part);
      }
      if (rgb) {
        PutColours(pixels, bx, by, picture.view->width, picture.view->height, rgb);
      } else {
        std::copy_n(pixels, kSoftPixels, reinterpret_cast<int32_t*>(colours[block].at));
      }
    }
  }
}

// Puts a block's pixels to their place in an image of rows.
template <class T>
HWY_INLINE void PutBlock(const T* from, int bx, int by, int width, int height, T* image) {
  static_assert(sizeof(T) == 4);
  const int rows = std::min(kSoftBlock, height - kSoftBlock * by);
  const int columns = std::min(kSoftBlock, width - kSoftBlock * bx);
  T* to = image + static_cast<size_t>(kSoftBlock * by) * width + kSoftBlock * bx;
  for (int r = 0; r < rows; ++r, to += width) {
    if (columns == kSoftBlock) {
      std::memcpy(to, from + kSoftBlock * r, kSoftBlock * sizeof(T));
    } else {
      std::copy_n(from + kSoftBlock * r, columns, to);
    }
  }
}

inline void ReadExactHere(const SoftPicture& picture, const SoftBuffer& buffer, float* metres,
                          int32_t* bodies) {
  const SoftView& view = *picture.view;
  const auto body_of = [&](uint32_t id) {
    return id == kSoftNothing ? -1
                              : picture.instances[picture.instance_of_run[id >> kSoftRunBits]].body;
  };
  for (int by = 0; by < buffer.rows; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      const uint32_t* ids = buffer.ids[block].at;
      if (metres) {
        alignas(64) float depth[kSoftPixels];
        for (int part = 0; part < kSoftPixels; part += kLanes) {
          const V q = LoadNearness(buffer, block, part);
          const V d = view.orthographic
                          ? hn::Sub(Num(view.far), hn::Mul(q, Num(view.far - view.near)))
                          : hn::Div(Num(1), q);
          const M seen =
              hn::RebindMask(kFloats, hn::Gt(LoadIds(buffer, block, part), hn::Set(kInts, -1)));
          hn::Store(hn::IfThenElseZero(seen, d), kFloats, depth + part);
        }
        PutBlock(depth, bx, by, view.width, view.height, metres);
      }
      if (bodies) {
        alignas(64) int32_t body[kSoftPixels];
        uint32_t others = 0;
        for (int k = 1; k < kSoftPixels; ++k) others |= (ids[k] ^ ids[0]) >> kSoftRunBits;
        if (others == 0) {  // one element, as in nearly all blocks
          std::fill_n(body, kSoftPixels, body_of(ids[0]));
        } else {
          for (int k = 0; k < kSoftPixels; ++k) body[k] = body_of(ids[k]);
        }
        PutBlock(body, bx, by, view.width, view.height, bodies);
      }
    }
  }
}

inline void BlendLayerHere(const SoftPicture& picture, const SoftBuffer& behind,
                           const SoftBuffer& layer, float alpha, SoftIds* colours) {
  for (int by = 0; by < layer.rows; ++by) {
    for (int bx = 0; bx < layer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * layer.columns + bx;
      for (int part = 0; part < kSoftPixels; part += kLanes) {
        I ids = hn::Load(kInts, reinterpret_cast<const int32_t*>(layer.ids[block].at) + part);
        const V nearness = hn::Load(kFloats, layer.nearness[block].at + part);
        const M seen =
            hn::And(hn::RebindMask(kFloats, hn::Gt(ids, hn::Set(kInts, -1))),
                    hn::Ge(nearness, hn::Load(kFloats, behind.nearness[block].at + part)));
        if (hn::AllFalse(kFloats, seen)) continue;
        ids = hn::IfThenElse(hn::RebindMask(kInts, seen), ids, hn::Set(kInts, -1));
        const Pixels p = PixelsAt(*picture.view, bx, by, part, nearness);
        auto* at = reinterpret_cast<int32_t*>(colours[block].at) + part;
        const Colour under = Unpack(hn::Load(kInts, at));
        const V scale = Num(1.0f / 255);
        const Colour before{hn::Mul(under.r, scale), hn::Mul(under.g, scale),
                            hn::Mul(under.b, scale)};
        const Colour after =
            Mix(before, ShadePixels(picture, p, ids), hn::IfThenElseZero(seen, Num(alpha)));
        hn::Store(PackPixels(after), kInts, at);
      }
    }
  }
}

inline void PackColoursHere(const SoftBuffer& buffer, const SoftIds* colours, uint8_t* rgb) {
  for (int by = 0; by < buffer.rows; ++by) {
    for (int bx = 0; bx < buffer.columns; ++bx) {
      const size_t block = static_cast<size_t>(by) * buffer.columns + bx;
      PutColours(reinterpret_cast<const int32_t*>(colours[block].at), bx, by, buffer.width,
                 buffer.height, rgb);
    }
  }
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
