// Light on surfaces; part of soft_kernel.cc, compiled for each instruction set.
#if defined(ROBOCELL_SOFT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ROBOCELL_SOFT_LIGHT_INL_H_
#undef ROBOCELL_SOFT_LIGHT_INL_H_
#else
#define ROBOCELL_SOFT_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_pixels-inl.h"
#include "robocell/render/soft_shadow_map-inl.h"
#include "robocell/render/soft_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

// The mirror image of a light. `along` and `across` are the products of the directions to the eye
// with the normal and with the direction to the light.
HWY_INLINE V Highlight(const SoftMaterial& material, V strength, V facing, V along_eye,
                       V light_eye) {
  // Most pixels are far from the highlight; what is left out is less than half a step of colour.
  const V zero = hn::Zero(kFloats);
  // Of the sum of both directions, with the normal and with itself.
  const V along = hn::Add(facing, along_eye);
  const V length2 = hn::Max(hn::Add(Num(2), hn::Add(light_eye, light_eye)), Num(1e-4f));
  const V along2 = hn::Mul(along, along);
  const M bright = hn::And(hn::And(hn::Gt(facing, zero), hn::Gt(along, zero)),
                           hn::Ge(along2, hn::Mul(Num(material.least_shine), length2)));
  if (hn::AllFalse(kFloats, bright)) return zero;
  const V power = Power(Clamp01(hn::Div(along2, length2)), 0.5f * material.shininess);
  return hn::IfThenElseZero(bright, hn::Mul(hn::Mul(strength, Num(material.specular)), power));
}

// The direction to the light, and how much of it arrives where nothing hides it.
HWY_INLINE V3 Towards(const SoftLight& light, const V3& at, V* strength) {
  *strength = Num(1);
  if (light.directional) return Set3(light.direction);
  const V3 offset = Sub(Set3(light.position), at);
  const V distance2 = hn::Max(Dot(offset, offset), Num(1e-30f));
  const V per_distance = PerRoot(distance2), distance = hn::Mul(distance2, per_distance);
  const V3 to = Times(per_distance, offset);
  const V fade = hn::Add(Num(light.attenuation[0]),
                         hn::Mul(distance, hn::Add(Num(light.attenuation[1]),
                                                   hn::Mul(distance, Num(light.attenuation[2])))));
  *strength = hn::Div(Num(1), fade);
  if (light.cutoff_cosine > -1) {
    const V off = hn::Neg(Dot(to, Set3(light.direction)));
    const V beam = Power(Clamp01(off), light.exponent);
    *strength = hn::IfThenElseZero(hn::Ge(off, Num(light.cutoff_cosine)), hn::Mul(*strength, beam));
  }
  return to;
}

// What is the same everywhere on a flat face: light from far away that nothing hides, without
// highlights.
struct FaceLight {
  static constexpr int kMost = 128;  // the engine has fewer
  bool plain = false;                // all lights are far away
  float sum[3];
  float facing[kMost];

  inline void Be(const SoftPicture& picture, const SoftMaterial& material, const float* normal) {
    plain = picture.light_count <= kMost;
    for (int l = 0; l < picture.light_count; ++l) plain &= picture.lights[l].directional;
    if (!plain) return;
    const float own = material.emission + picture.ambient;
    for (int c = 0; c < 3; ++c) sum[c] = own * material.rgba[c];
    for (int l = 0; l < picture.light_count; ++l) {
      const SoftLight& light = picture.lights[l];
      const float* to = light.direction;
      facing[l] = (normal[0] * to[0] + normal[1] * to[1]) + normal[2] * to[2];
      if (picture.shadows && light.shadow) continue;
      const float diffuse = std::max(facing[l], 0.0f);
      for (int c = 0; c < 3; ++c) {
        sum[c] += (light.ambient[c] + diffuse * light.diffuse[c]) * material.rgba[c];
      }
    }
  }
};

// Light on a surface. Highlights are added last, so that the rest may come from `face`, which a flat
// one has; others have null.
HWY_INLINE Colour Light(const SoftPicture& picture, const SoftMaterial& material, const Pixels& p,
                        const V3& normal, const FaceLight* face) {
  if (face && !face->plain) face = nullptr;
  const V base[3] = {Num(material.rgba[0]), Num(material.rgba[1]), Num(material.rgba[2])};
  const V zero = hn::Zero(kFloats);
  V sum[3];
  for (int c = 0; c < 3; ++c) {
    sum[c] = face ? Num(face->sum[c]) : hn::Mul(Num(material.emission + picture.ambient), base[c]);
  }
  V shine[3] = {zero, zero, zero};
  // The engine adds each light that casts shadows in a picture of its own.
  V added[3] = {zero, zero, zero};
  V3 eye{zero, zero, zero};
  V along_eye = zero;
  if (material.shines) {
    eye =
        Unit(picture.view->orthographic ? V3{hn::Neg(p.at.x), hn::Neg(p.at.y), hn::Neg(p.at.z)}
                                        : V3{hn::Neg(p.ray.x), hn::Neg(p.ray.y), hn::Neg(p.ray.z)});
    along_eye = Dot(normal, eye);
  }
  for (int l = 0; l < picture.light_count; ++l) {
    const SoftLight& light = picture.lights[l];
    const bool shadowed = picture.shadows && light.shadow;
    const bool shines = material.shines && light.shines;
    if (face && !shadowed && !(shines && face->facing[l] > 0)) continue;
    V strength = Num(1), facing = zero;
    V3 to = Set3(light.direction);
    if (face) {
      facing = Num(face->facing[l]);
    } else {
      to = Towards(light, p.at, &strength);
      facing = Dot(normal, to);
    }
    if (shadowed) strength = hn::Mul(strength, Lit(*light.shadow, p.at, normal, facing));
    V highlight = zero;
    if (shines) highlight = Highlight(material, strength, facing, along_eye, Dot(to, eye));
    const V diffuse = hn::Mul(strength, hn::Max(facing, zero));
    for (int c = 0; c < 3; ++c) {
      const V mirrored = hn::Mul(highlight, Num(light.specular[c]));
      const V reflected = hn::Mul(hn::Add(hn::Mul(strength, Num(light.ambient[c])),
                                          hn::Mul(diffuse, Num(light.diffuse[c]))),
                                  base[c]);
      if (shadowed) {
        added[c] = hn::Add(added[c], Clamp01(hn::Add(reflected, mirrored)));
      } else {
        if (!face) sum[c] = hn::Add(sum[c], reflected);
        shine[c] = hn::Add(shine[c], mirrored);
      }
    }
  }
  return {hn::Add(Clamp01(hn::Add(sum[0], shine[0])), added[0]),
          hn::Add(Clamp01(hn::Add(sum[1], shine[1])), added[1]),
          hn::Add(Clamp01(hn::Add(sum[2], shine[2])), added[2])};
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
