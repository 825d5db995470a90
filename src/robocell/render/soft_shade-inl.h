// Colours of visible surfaces; part of soft_kernel.cc, compiled for each instruction set.
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

HWY_INLINE V Square(V u, V v) { return hn::Add(hn::Mul(u, u), hn::Mul(v, v)); }

inline float DotOf(const float* a, const float* b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

// The steps of positions in the mesh's axes from pixel to pixel, at depth 1 and without the face's
// part.
struct MeshSteps {
  float right[3], down[3];

  MeshSteps(const SoftView& view, const float* m)
      : right{view.per_fx * m[0], view.per_fx * m[4], view.per_fx * m[8]},
        down{-view.per_fy * m[1], -view.per_fy * m[5], -view.per_fy * m[9]} {}
};

// Computes the origin of rays, or with orthographic cameras the direction to it, in the mesh's
// axes.
inline void EyeOf(const SoftView& view, const float* m, float* eye) {
  for (int k = 0; k < 3; ++k) eye[k] = m[4 * k + (view.orthographic ? 2 : 3)];
}

// Change of depth along the ray per step to the right and down, as a share of the ray.
struct FaceSlope {
  V right, down;
};

// Gives the same bits as SlopesOf.
inline void SlopeOf(const SoftView& view, const SoftMesh& mesh, int triangle, const float* m,
                    float* right, float* down) {
  const MeshSteps steps(view, m);
  float eye[3];
  EyeOf(view, m, eye);
  const float n[3] = {mesh.facing[0][triangle], mesh.facing[1][triangle], mesh.facing[2][triangle]};
  const float to_eye = DotOf(n, eye) + (view.orthographic ? 0.0f : mesh.facing[3][triangle]);
  const float steep = 1 / std::copysign(std::max(std::abs(to_eye), 1e-20f), to_eye);
  *right = DotOf(n, steps.right) * steep;
  *down = DotOf(n, steps.down) * steep;
}

HWY_INLINE FaceSlope SlopesOf(const SoftView& view, const SoftMesh& mesh, I triangle,
                              const float* m) {
  const MeshSteps steps(view, m);
  float eye[3];
  EyeOf(view, m, eye);
  const auto plane = [&](int k) HWY_ATTR {
    return hn::GatherIndex(kFloats, mesh.facing[k].data(), triangle);
  };
  const V3 n{plane(0), plane(1), plane(2)};
  const V to_eye = hn::Add(Dot(n, Set3(eye)), view.orthographic ? hn::Zero(kFloats) : plane(3));
  const V steep = hn::Div(Num(1), hn::CopySign(hn::Max(hn::Abs(to_eye), Num(1e-20f)), to_eye));
  return {hn::Mul(Dot(n, Set3(steps.right)), steep), hn::Mul(Dot(n, Set3(steps.down)), steep)};
}

// Changes of the position `at` from pixel to pixel, in the mesh's axes.
HWY_INLINE void Changes(const SoftView& view, const float* m, V depth, const V3& at,
                        const FaceSlope& slope, V3* right, V3* down) {
  const MeshSteps steps(view, m);
  float eye[3];
  EyeOf(view, m, eye);
  if (view.orthographic) {
    const V3 ray = {Num(-eye[0]), Num(-eye[1]), Num(-eye[2])};
    *right = Add(Set3(steps.right), Times(slope.right, ray));
    *down = Add(Set3(steps.down), Times(slope.down, ray));
    return;
  }
  const V3 ray = Sub(at, Set3(eye));
  *right = Times(depth, Add(Set3(steps.right), Times(slope.right, ray)));
  *down = Times(depth, Add(Set3(steps.down), Times(slope.down, ray)));
}

// Returns the normal of a flat triangle in view axes: the same bits as the general way.
HWY_INLINE void FlatNormal(const float* m, const SoftSurface& surface, float* normal) {
  const auto part = [&](int k) {
    return static_cast<float>(static_cast<int16_t>(surface.normals[k / 2] >> (16 * (k % 2))));
  };
  const float n[3] = {part(0), part(1), part(2)};
  for (int k = 0; k < 3; ++k) normal[k] = (n[0] * m[k] + n[1] * m[4 + k]) + n[2] * m[8 + k];
  const float scale = PerRoot(std::max(DotOf(normal, normal), 1e-30f));
  for (int k = 0; k < 3; ++k) normal[k] = scale * normal[k];
}

// The last flat face that was coloured: neighbouring blocks often show it too.
struct SoftFace {
  const SoftInstance* instance = nullptr;
  int triangle = -1;
  float normal[3], slope_right = 0, slope_down = 0;
  FaceLight light;

  HWY_INLINE void Be(const SoftPicture& picture, const SoftInstance& other, int number) {
    if (instance == &other && triangle == number) return;
    Take(picture, other, number);
  }

 private:
  HWY_NOINLINE void Take(const SoftPicture& picture, const SoftInstance& other, int number) {
    instance = &other;
    triangle = number;
    FlatNormal(other.to_mesh, other.mesh->surface[number], normal);
    light.Be(picture, other, normal);
    if (other.material.mapping == SoftMapping::kNone) return;
    SlopeOf(*picture.view, *other.mesh, number, other.to_mesh, &slope_right, &slope_down);
  }
};

constexpr int kSurfaceWords = 16;
static_assert(sizeof(SoftSurface) == 4 * kSurfaceWords);

// The corners' data of one triangle in all lanes.
struct OneSurface {
  const SoftSurface& s;
  int triangle;

  HWY_INLINE V To1(int k) const { return Num(s.to1[k]); }
  HWY_INLINE V To2(int k) const { return Num(s.to2[k]); }
  HWY_INLINE V At1() const { return Num(s.at1); }
  HWY_INLINE V At2() const { return Num(s.at2); }
  HWY_INLINE float Part(int k) const {
    return static_cast<float>(static_cast<int16_t>(s.normals[k / 2] >> (16 * (k % 2))));
  }
  HWY_INLINE V Normal(int k) const { return Num(Part(k)); }
  HWY_INLINE V NormalStep(int k, int corner) const { return Num(Part(3 * corner + k) - Part(k)); }
  HWY_INLINE V Texture(const SoftMesh& mesh, int k) const {
    return Num(mesh.texture[SoftMesh::kTexture * triangle + k]);
  }
};

// Those of a triangle in each lane.
struct SomeSurfaces {
  I words[12], last;
  I triangle;

  HWY_INLINE SomeSurfaces(const SoftMesh& mesh, I numbers) : triangle(numbers) {
    const auto* from = reinterpret_cast<const int32_t*>(mesh.surface.data());
    const I start = hn::Mul(numbers, hn::Set(kInts, kSurfaceWords));
#if HWY_TARGET == HWY_SCALAR
    for (int w = 0; w < 12; ++w) words[w] = hn::GatherIndex(kInts, from + w, start);
#else
    alignas(64) int32_t starts[kSoftPixels];
    hn::Store(start, kInts, starts);
    for (int w = 0; w < 12; w += 4) {
      // Four words of the surfaces of lanes k, k + 4, k + 8, k + 12.
      const auto rows = [&](int k) HWY_ATTR {
        const auto row = [&](int lane)
                             HWY_ATTR { return hn::LoadDup128(kInts, from + starts[lane] + w); };
        if constexpr (kLanes == 16) {
          return hn::ConcatLowerLower(kInts, hn::OddEvenBlocks(row(k + 12), row(k + 8)),
                                      hn::OddEvenBlocks(row(k + 4), row(k)));
        } else if constexpr (kLanes == 8) {
          return hn::OddEvenBlocks(row(k + 4), row(k));
        } else {
          return row(k);
        }
      };
      const I a = rows(0), b = rows(1), c = rows(2), d = rows(3);
      const I ac = hn::InterleaveLower(kInts, a, c), bd = hn::InterleaveLower(kInts, b, d);
      const I ac2 = hn::InterleaveUpper(kInts, a, c), bd2 = hn::InterleaveUpper(kInts, b, d);
      words[w] = hn::InterleaveLower(kInts, ac, bd);
      words[w + 1] = hn::InterleaveUpper(kInts, ac, bd);
      words[w + 2] = hn::InterleaveLower(kInts, ac2, bd2);
      words[w + 3] = hn::InterleaveUpper(kInts, ac2, bd2);
    }
#endif
    last = hn::GatherIndex(kInts, from + 12, start);
  }

  HWY_INLINE V To1(int k) const { return hn::BitCast(kFloats, words[k]); }
  HWY_INLINE V To2(int k) const { return hn::BitCast(kFloats, words[4 + k]); }
  HWY_INLINE V At1() const { return hn::BitCast(kFloats, words[3]); }
  HWY_INLINE V At2() const { return hn::BitCast(kFloats, words[7]); }
  HWY_INLINE V Normal(int k) const {
    const I both = k == 8 ? last : words[8 + k / 2];
    return hn::ConvertTo(kFloats, k % 2 == 0 ? hn::ShiftRight<16>(hn::ShiftLeft<16>(both))
                                             : hn::ShiftRight<16>(both));
  }
  HWY_INLINE V NormalStep(int k, int corner) const {
    return hn::Sub(Normal(3 * corner + k), Normal(k));
  }
  HWY_INLINE V Texture(const SoftMesh& mesh, int k) const {
    return hn::GatherIndex(kFloats, mesh.texture.data() + k,
                           hn::Mul(triangle, hn::Set(kInts, SoftMesh::kTexture)));
  }
};

HWY_INLINE V3 InMesh(const float* m, const V3& at) {
  const V3 turned = Turned(m, 4, at);
  return {hn::Add(turned.x, Num(m[3])), hn::Add(turned.y, Num(m[7])),
          hn::Add(turned.z, Num(m[11]))};
}

// The two corners' weights in a surface: functions of the position.
struct CornerWeights {
  V3 to1, to2;
  V w1, w2;
};

// Returns the texture's colour. `coordinate` gives numbers of the mesh's texture by their index.
template <class Coordinate>
HWY_INLINE Colour Texel(const SoftMaterial& material, const V3& at, const V3& right, const V3& down,
                        const CornerWeights& corners, const Coordinate& coordinate) {
  const SoftTexture& texture = *material.texture;
  if (material.mapping == SoftMapping::kCube) {
    const V3 scale = Set3(material.scale);
    const auto scaled = [&](const V3& v) HWY_ATTR {
      return V3{hn::Mul(v.x, scale.x), hn::Mul(v.y, scale.y), hn::Mul(v.z, scale.z)};
    };
    const V3 r = scaled(right), d = scaled(down);
    return SampleCube(texture, scaled(at), hn::Max(Dot(r, r), Dot(d, d)));
  }
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
    const V su = Num(material.scale[0]), sv = Num(material.scale[1]);
    const V u1 = hn::Mul(su, coordinate(2)), v1 = hn::Mul(sv, coordinate(3)),
            u2 = hn::Mul(su, coordinate(4)), v2 = hn::Mul(sv, coordinate(5));
    const auto mix = [&](V a, V b, V first, V second)
                         HWY_ATTR { return hn::Add(hn::Mul(a, first), hn::Mul(b, second)); };
    u = hn::Add(hn::Mul(su, coordinate(0)), mix(corners.w1, corners.w2, u1, u2));
    v = hn::Add(hn::Mul(sv, coordinate(1)), mix(corners.w1, corners.w2, v1, v2));
    const V r1 = Dot(corners.to1, right), r2 = Dot(corners.to2, right), d1 = Dot(corners.to1, down),
            d2 = Dot(corners.to2, down);
    ur = mix(r1, r2, u1, u2);
    vr = mix(r1, r2, v1, v2);
    ud = mix(d1, d2, u1, u2);
    vd = mix(d1, d2, v1, v2);
  }
  const V w = Num(static_cast<float>(texture.width)), h = Num(static_cast<float>(texture.height));
  const V square =
      hn::Max(Square(hn::Mul(ur, w), hn::Mul(vr, h)), Square(hn::Mul(ud, w), hn::Mul(vd, h)));
  return Sample(texture, hn::Zero(kInts), u, v, square);
}

HWY_INLINE Colour Product(const Colour& a, const Colour& b) {
  return {hn::Mul(a.r, b.r), hn::Mul(a.g, b.g), hn::Mul(a.b, b.b)};
}

// Colours pixels that all show one flat triangle: the same bits as the general way.
HWY_INLINE Colour ShadeFace(const SoftPicture& picture, const SoftInstance& instance,
                            const Pixels& p, int triangle, SoftFace* face) {
  face->Be(picture, instance, triangle);
  const SoftMaterial& material = instance.material;
  const Colour c = Light(picture, instance, p, Set3(face->normal), &face->light);
  if (material.mapping == SoftMapping::kNone) return c;
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_mesh;
  const V3 at = InMesh(m, p.at);
  V3 right, down;
  Changes(*picture.view, m, p.depth, at, {Num(face->slope_right), Num(face->slope_down)}, &right,
          &down);
  CornerWeights corners{};
  if (material.mapping == SoftMapping::kMesh) {
    const SoftSurface& s = mesh.surface[triangle];
    corners.to1 = Set3(s.to1);
    corners.to2 = Set3(s.to2);
    corners.w1 = Clamp01(hn::Sub(Dot(at, corners.to1), Num(s.at1)));
    corners.w2 = Clamp01(hn::Sub(Dot(at, corners.to2), Num(s.at2)));
  }
  return Product(c, Texel(material, at, right, down, corners, [&](int k) HWY_ATTR {
                   return Num(mesh.texture[SoftMesh::kTexture * triangle + k]);
                 }));
}

template <class Surfaces>
HWY_INLINE Colour ShadeSurfaces(const SoftPicture& picture, const SoftInstance& instance,
                                const Pixels& p, I triangle, const Surfaces& surfaces) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_mesh;
  const V3 at = InMesh(m, p.at);
  CornerWeights corners{{surfaces.To1(0), surfaces.To1(1), surfaces.To1(2)},
                        {surfaces.To2(0), surfaces.To2(1), surfaces.To2(2)},
                        {},
                        {}};
  corners.w1 = Clamp01(hn::Sub(Dot(at, corners.to1), surfaces.At1()));
  corners.w2 = Clamp01(hn::Sub(Dot(at, corners.to2), surfaces.At2()));
  const auto between = [&](int k) HWY_ATTR {
    return hn::Add(surfaces.Normal(k), hn::Add(hn::Mul(corners.w1, surfaces.NormalStep(k, 1)),
                                               hn::Mul(corners.w2, surfaces.NormalStep(k, 2))));
  };
  const V3 normal = Unit(TurnedBack(m, 4, {between(0), between(1), between(2)}));
  const SoftMaterial& material = instance.material;
  const Colour c = Light(picture, instance, p, normal, nullptr);
  if (material.mapping == SoftMapping::kNone) return c;
  V3 right, down;
  Changes(*picture.view, m, p.depth, at, SlopesOf(*picture.view, mesh, triangle, m), &right, &down);
  return Product(c, Texel(material, at, right, down, corners,
                          [&](int k) HWY_ATTR { return surfaces.Texture(mesh, k); }));
}

// Pixels that all show one triangle.
inline HWY_NOINLINE Colour ShadeOne(const SoftPicture& picture, const SoftInstance& instance,
                                    const Pixels& p, int triangle, SoftFace* face) {
  const SoftSurface& surface = instance.mesh->surface[triangle];
  if (surface.flat) return ShadeFace(picture, instance, p, triangle, face);
  return ShadeSurfaces(picture, instance, p, hn::Set(kInts, triangle),
                       OneSurface{surface, triangle});
}

// Pixels that show a triangle of the instance each.
inline HWY_NOINLINE Colour ShadeSome(const SoftPicture& picture, const SoftInstance& instance,
                                     const Pixels& p, I triangle) {
  return ShadeSurfaces(picture, instance, p, triangle, SomeSurfaces(*instance.mesh, triangle));
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

HWY_INLINE V3 SkyRay(const SoftPicture& picture, const Pixels& p) {
  return picture.view->orthographic ? V3{hn::Zero(kFloats), hn::Zero(kFloats), Num(-1)} : p.ray;
}

// Returns the pixels in which sky or haze may hide the surface; near surfaces stay visible.
HWY_INLINE M MayBeSky(const SoftPicture& picture, const Pixels& p) {
  const SoftSky& sky = picture.sky;
  const V3 ray = SkyRay(picture, p);
  const float haze_begins = sky.elevation > 0 ? 1 - sky.haze : 1;
  const V within = Num(0.7f * haze_begins * sky.radius);
  const V length2 = hn::Mul(hn::Mul(p.depth, p.depth), Dot(ray, ray));
  return hn::Gt(length2, hn::Mul(within, within));
}

// Adds sky and haze, which hide surfaces beyond them. `nothing`: pixels without a surface.
HWY_INLINE Colour WithSky(const SoftPicture& picture, const Pixels& p, M nothing, Colour c) {
  const SoftSky& sky = picture.sky;
  if (!sky.texture) {
    const V zero = hn::Zero(kFloats);
    return {hn::IfThenElse(nothing, zero, c.r), hn::IfThenElse(nothing, zero, c.g),
            hn::IfThenElse(nothing, zero, c.b)};
  }
  const V3 ray = SkyRay(picture, p);
  const M may_be = hn::Or(nothing, MayBeSky(picture, p));
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

// Returns the colours of a register of pixels; black without a surface.
HWY_INLINE Colour ShadePixels(const SoftPicture& picture, const Pixels& p, I ids, SoftFace* face) {
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
      return ShadeOne(picture, instance, p, all[k] - first, face);
    }
    const I triangle = hn::Sub(ids, hn::Set(kInts, first));
    const auto of_this = hn::And(hn::Gt(triangle, hn::Set(kInts, -1)),
                                 hn::Lt(triangle, hn::Set(kInts, instance.mesh->triangles)));
    const Colour here = ShadeSome(picture, instance, p, hn::IfThenElseZero(of_this, triangle));
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

HWY_INLINE M InOneRun(I a, I b) {
  return hn::RebindMask(kFloats,
                        hn::Eq(hn::ShiftRight<kSoftRunBits>(hn::Xor(a, b)), hn::Zero(kInts)));
}

HWY_INLINE I LoadIds(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kInts, reinterpret_cast<const int32_t*>(buffer.ids[block].at) + part);
}
HWY_INLINE V LoadNearness(const SoftBuffer& buffer, size_t block, int part) {
  return hn::Load(kFloats, buffer.nearness[block].at + part);
}

// Adds the reflection, in front of which there is nothing.
HWY_INLINE Colour WithReflection(const SoftPicture& picture, size_t block, int bx, int by, int part,
                                 I ids, V nearness, const Colour& c, SoftFace* face) {
  const SoftReflection& r = *picture.reflection;
  const I triangle = hn::Sub(ids, hn::Set(kInts, static_cast<int32_t>(r.first_id)));
  const auto on_face =
      hn::And(hn::Gt(triangle, hn::Set(kInts, -1)), hn::Lt(triangle, hn::Set(kInts, r.triangles)));
  if (hn::AllFalse(kInts, on_face)) return c;
  // In the mirror image, surfaces in front of the face lie behind it.
  const V near = LoadNearness(r.buffer, block, part);
  const auto shown =
      hn::And(on_face, hn::RebindMask(kInts, hn::Le(near, hn::Mul(nearness, Num(1.0001f)))));
  const I other = hn::IfThenElse(shown, LoadIds(r.buffer, block, part), hn::Set(kInts, -1));
  if (hn::AllFalse(kInts, hn::Gt(other, hn::Set(kInts, -1)))) return c;
  const Colour of_mirror =
      ShadePixels(r.picture, PixelsAt(*picture.view, bx, by, part, near), other, face);
  return {hn::Add(c.r, of_mirror.r), hn::Add(c.g, of_mirror.g), hn::Add(c.b, of_mirror.b)};
}

// Writes a block's pixels as 3 bytes each into an image of rows. Blocks come from the left to the
// right: bytes beyond the block are overwritten later.
HWY_INLINE void PutColours(const int32_t* pixels, int bx, int by, int width, int height,
                           uint8_t* rgb) {
  const int rows = std::min(kSoftBlock, height - kSoftBlock * by);
  const int columns = std::min(kSoftBlock, width - kSoftBlock * bx);
  uint8_t* to = rgb + 3 * (static_cast<size_t>(kSoftBlock * by) * width + kSoftBlock * bx);
#if HWY_TARGET != HWY_SCALAR
  constexpr int kBytes = 16;
  if (3 * (width - kSoftBlock * bx) >= kBytes) {
    constexpr hn::CappedTag<uint8_t, kBytes> bytes;
    alignas(16) static constexpr uint8_t kOrder[kBytes] = {0,  1,  2,  4,  5,    6,    8,    9,
                                                           10, 12, 13, 14, 0x80, 0x80, 0x80, 0x80};
    const auto order = hn::Load(bytes, kOrder);
    for (int r = 0; r < rows; ++r, to += 3 * width) {
      const auto row = hn::Load(bytes, reinterpret_cast<const uint8_t*>(pixels + kSoftBlock * r));
      hn::StoreU(hn::TableLookupBytesOr0(row, order), bytes, to);
    }
    return;
  }
#endif
  for (int r = 0; r < rows; ++r, to += 3 * width) {
    for (int k = 0; k < columns; ++k) {
      std::memcpy(to + 3 * k, pixels + kSoftBlock * r + k, 3);
    }
  }
}

// Writes a block's pixels into an image of rows.
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

inline void ReadExactHere(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                          float* metres, int32_t* bodies) {
  const SoftView& view = *picture.view;
  const auto body_of = [&](uint32_t id) {
    return id == kSoftNothing ? -1
                              : picture.instances[picture.instance_of_run[id >> kSoftRunBits]].body;
  };
  for (int by = rows.begin; by < rows.end; ++by) {
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
        const I first = hn::Set(kInts, static_cast<int32_t>(ids[0]));
        bool one = true;  // element, as in nearly all blocks
        for (int part = 0; part < kSoftPixels && one; part += kLanes) {
          one = hn::AllTrue(kFloats, InOneRun(LoadIds(buffer, block, part), first));
        }
        if (one) {
          for (int part = 0; part < kSoftPixels; part += kLanes) {
            hn::Store(hn::Set(kInts, body_of(ids[0])), kInts, body + part);
          }
        } else {
          for (int k = 0; k < kSoftPixels; ++k) body[k] = body_of(ids[k]);
        }
        PutBlock(body, bx, by, view.width, view.height, bodies);
      }
    }
  }
}

inline void BlendLayerHere(const SoftPicture& picture, const SoftBuffer& behind,
                           const SoftBuffer& layer, SoftRows rows, float alpha, SoftIds* colours) {
  SoftFace face;
  for (int by = rows.begin; by < rows.end; ++by) {
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
            Mix(before, ShadePixels(picture, p, ids, &face), hn::IfThenElseZero(seen, Num(alpha)));
        hn::Store(PackPixels(after), kInts, at);
      }
    }
  }
}

inline void PackColoursHere(const SoftBuffer& buffer, SoftRows rows, const SoftIds* colours,
                            uint8_t* rgb) {
  for (int by = rows.begin; by < rows.end; ++by) {
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
