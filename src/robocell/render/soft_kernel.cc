#include "robocell/render/soft_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/render/soft_kernel.cc"
// As in kinematics/lane_kernel.cc.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/render/soft_raster-inl.h"
// Needs the one before.
#include "robocell/render/soft_shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

int64_t Instructions() { return HWY_TARGET; }
void Draw(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
          SoftBuffer* buffer) {
  DrawInstanceHere(view, instance, scratch, buffer);
}
void Shade(const SoftPicture& picture, const SoftBuffer& buffer, SoftIds* colours) {
  ShadePictureHere(picture, buffer, colours);
}
void Blend(const SoftPicture& picture, const SoftBuffer& behind, const SoftBuffer& layer,
           float alpha, SoftIds* colours) {
  BlendLayerHere(picture, behind, layer, alpha, colours);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {
HWY_EXPORT(Instructions);
HWY_EXPORT(Draw);
HWY_EXPORT(Shade);
HWY_EXPORT(Blend);

std::string SoftInstructions() { return hwy::TargetName(HWY_DYNAMIC_DISPATCH(Instructions)()); }

void ClearBuffer(const SoftView& view, SoftBuffer* buffer) {
  buffer->width = view.width;
  buffer->height = view.height;
  buffer->columns = (view.width + kSoftBlock - 1) / kSoftBlock;
  buffer->rows = (view.height + kSoftBlock - 1) / kSoftBlock;
  const size_t blocks = static_cast<size_t>(buffer->columns) * static_cast<size_t>(buffer->rows);
  // What is farther than the far plane is not nearer than this.
  const float farthest = view.orthographic ? 0.0f : 1 / view.far;
  SoftNumbers none;
  std::fill_n(none.at, kSoftPixels, farthest);
  SoftIds nothing;
  std::fill_n(nothing.at, kSoftPixels, kSoftNothing);
  buffer->nearness.assign(blocks, none);
  buffer->ids.assign(blocks, nothing);
}

void DrawInstance(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                  SoftBuffer* buffer) {
  const auto grow = [](auto& row, size_t size) {
    if (row.size() < size) row.resize(size);
  };
  const size_t vertices = static_cast<size_t>(instance.mesh->vertices) + kSoftPadding,
               triangles = static_cast<size_t>(instance.mesh->triangles) + 2 * kSoftPadding;
  for (auto* row : {&scratch->x, &scratch->y, &scratch->nearness}) grow(*row, vertices);
  grow(scratch->facing, triangles);
  grow(scratch->cut, triangles);
  HWY_DYNAMIC_DISPATCH(Draw)(view, instance, scratch, buffer);
}

void ReadExact(const SoftPicture& picture, const SoftBuffer& buffer, std::span<float> metres,
               std::span<int32_t> bodies) {
  const SoftView& view = *picture.view;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const size_t block = static_cast<size_t>(y / kSoftBlock) * buffer.columns + x / kSoftBlock;
      const int k = y % kSoftBlock * kSoftBlock + x % kSoftBlock;
      const size_t pixel = static_cast<size_t>(y) * view.width + x;
      const uint32_t id = buffer.ids[block].at[k];
      const float nearness = buffer.nearness[block].at[k];
      if (!metres.empty()) {
        metres[pixel] = id == kSoftNothing  ? 0
                        : view.orthographic ? view.far - nearness * (view.far - view.near)
                                            : 1 / nearness;
      }
      if (!bodies.empty()) {
        bodies[pixel] = id == kSoftNothing
                            ? -1
                            : picture.instances[picture.instance_of_run[id >> kSoftRunBits]].body;
      }
    }
  }
}

void ShadePicture(const SoftPicture& picture, const SoftBuffer& buffer,
                  std::span<SoftIds> colours) {
  HWY_DYNAMIC_DISPATCH(Shade)(picture, buffer, colours.data());
}

void BlendLayer(const SoftPicture& picture, const SoftBuffer& behind, const SoftBuffer& layer,
                float alpha, std::span<SoftIds> colours) {
  HWY_DYNAMIC_DISPATCH(Blend)(picture, behind, layer, alpha, colours.data());
}

void PackColours(const SoftBuffer& buffer, std::span<const SoftIds> colours,
                 std::span<uint8_t> rgb) {
  uint8_t* to = rgb.data();
  for (int y = 0; y < buffer.height; ++y) {
    const SoftIds* row = colours.data() + static_cast<size_t>(y / kSoftBlock) * buffer.columns;
    for (int x = 0; x < buffer.width; x += kSoftBlock, ++row) {
      const uint32_t* from = row->at + y % kSoftBlock * kSoftBlock;
      for (int k = 0; k < std::min(kSoftBlock, buffer.width - x); ++k, to += 3) {
        to[0] = static_cast<uint8_t>(from[k]);
        to[1] = static_cast<uint8_t>(from[k] >> 8);
        to[2] = static_cast<uint8_t>(from[k] >> 16);
      }
    }
  }
}

}  // namespace robocell::internal
#endif
