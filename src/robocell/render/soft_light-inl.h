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

// The mirror image of a light, or 0. `along` and `across` are the products of the directions to the
// eye with the normal and with the direction to the light.
HWY_INLINE V Highlight(const SoftMaterial& material, V facing, V along_eye, V light_eye) {
  // Most pixels are far from the highlight; the omitted part is less than half a step of colour.
  const V zero = hn::Zero(kFloats);
  // The products of the sum of both directions with the normal and with itself.
  const V along = hn::Add(facing, along_eye);
  const V length2 = hn::Max(hn::Add(Num(2), hn::Add(light_eye, light_eye)), Num(1e-4f));
  const V along2 = hn::Mul(along, along);
  const M bright = hn::And(hn::And(hn::Gt(facing, zero), hn::Gt(along, zero)),
                           hn::Ge(along2, hn::Mul(Num(material.least_shine), length2)));
  if (hn::AllFalse(kFloats, bright)) return zero;
  const V power = Power(Clamp01(hn::Div(along2, length2)), 0.5f * material.shininess);
  return hn::IfThenElseZero(bright, power);
}

// Returns the direction to the light, and its strength if nothing hides it.
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

HWY_INLINE const SoftGain* GainsOf(const SoftPicture& picture, const SoftInstance& instance) {
  return picture.gains + (&instance - picture.instances) * picture.light_count;
}

// The constant light on a flat face: unhidden light from far away, without highlights.
struct FaceLight {
  static constexpr int kMost = 128;  // the engine has fewer
  bool plain = false;                // all lights are far away
  float sum[3];
  float facing[kMost];

  inline void Be(const SoftPicture& picture, const SoftInstance& instance, const float* normal) {
    plain = picture.light_count <= kMost;
    for (int l = 0; l < picture.light_count; ++l) plain &= picture.lights[l].directional;
    if (!plain) return;
    for (int c = 0; c < 3; ++c) sum[c] = instance.own[c];
    const SoftGain* gains = GainsOf(picture, instance);
    for (int l = 0; l < picture.light_count; ++l) {
      const SoftLight& light = picture.lights[l];
      const float* to = light.direction;
      facing[l] = (normal[0] * to[0] + normal[1] * to[1]) + normal[2] * to[2];
      if (picture.shadows && light.shadow) continue;
      const float diffuse = std::max(facing[l], 0.0f);
      for (int c = 0; c < 3; ++c) {
        if (!light.everywhere) sum[c] += gains[l].ambient[c];
        sum[c] += diffuse * gains[l].diffuse[c];
      }
    }
  }
};

// The direction to the eye.
HWY_INLINE V3 EyeAt(const SoftPicture& picture, const Pixels& p) {
  const V3& from = picture.view->orthographic ? p.at : p.ray;
  return Unit({hn::Neg(from.x), hn::Neg(from.y), hn::Neg(from.z)});
}

// Computes the light on a surface. Highlights are added last, so that the rest may come from
// `face`, which a flat one has; others have null.
HWY_INLINE Colour Light(const SoftPicture& picture, const SoftInstance& instance, const Pixels& p,
                        const V3& normal, const FaceLight* face) {
  if (face && !face->plain) face = nullptr;
  const SoftMaterial& material = instance.material;
  const SoftGain* gains = GainsOf(picture, instance);
  const float* start = face ? face->sum : instance.own;
  const V zero = hn::Zero(kFloats);
  V sum[3] = {Num(start[0]), Num(start[1]), Num(start[2])};
  V shine[3] = {zero, zero, zero};
  // The engine adds each light that casts shadows in a separate picture.
  V added[3] = {zero, zero, zero};
  V3 eye{zero, zero, zero};
  V along_eye = zero;
  if (material.shines) {
    eye = EyeAt(picture, p);
    along_eye = Dot(normal, eye);
  }
  for (int l = 0; l < picture.light_count; ++l) {
    const SoftLight& light = picture.lights[l];
    const SoftGain& gain = gains[l];
    const bool shadowed = picture.shadows && light.shadow;
    if (face && !shadowed && !(gain.shines && face->facing[l] > 0)) continue;
    V strength = Num(1), facing = zero;
    V3 to = Set3(light.direction);
    if (face) {
      facing = Num(face->facing[l]);
    } else if (light.directional) {
      facing = Dot(normal, to);
    } else {
      to = Towards(light, p.at, &strength);
      facing = Dot(normal, to);
    }
    if (shadowed) strength = hn::Mul(strength, Lit(*light.shadow, p.at, normal, facing));
    const V diffuse = hn::Mul(strength, hn::Max(facing, zero));
    V highlight = zero;
    if (gain.shines) {
      highlight = hn::Mul(strength, Highlight(material, facing, along_eye, Dot(to, eye)));
    }
    for (int c = 0; c < 3; ++c) {
      const V mirrored = hn::Mul(highlight, Num(gain.specular[c]));
      const V back = hn::Mul(diffuse, Num(gain.diffuse[c]));
      const V even = hn::Mul(strength, Num(gain.ambient[c]));
      if (shadowed) {
        added[c] = hn::Add(added[c], Clamp01(hn::Add(hn::Add(even, back), mirrored)));
        continue;
      }
      if (!face) {
        if (!light.everywhere) sum[c] = hn::Add(sum[c], even);
        sum[c] = hn::Add(sum[c], back);
      }
      shine[c] = hn::Add(shine[c], mirrored);
    }
  }
  return {hn::Add(Clamp01(hn::Add(sum[0], shine[0])), added[0]),
          hn::Add(Clamp01(hn::Add(sum[1], shine[1])), added[1]),
          hn::Add(Clamp01(hn::Add(sum[2], shine[2])), added[2])};
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // include guard
