#include "robocell/render/soft_kernel.h"

#include <algorithm>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/render/soft_kernel.cc"
// The targets of kinematics/lane_kernel.cc, and SSE4: without vectors an image takes too long.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/render/soft_edges-inl.h"
#include "robocell/render/soft_raster-inl.h"
#include "robocell/render/soft_run-inl.h"
#include "robocell/render/soft_samples-inl.h"
#include "robocell/render/soft_shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {

int64_t Instructions() { return HWY_TARGET; }
void Draw(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
          SoftBuffer* buffer) {
  DrawInstanceHere(view, instance, scratch, buffer);
}
void Exact(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows, float* metres,
           int32_t* bodies) {
  ReadExactHere(picture, buffer, rows, metres, bodies);
}
void Shade(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
           const uint8_t* wanted, SoftIds* colours, uint8_t* rgb) {
  ShadePictureHere(picture, buffer, rows, wanted, colours, rgb);
}
void Reach(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
           const uint8_t* wanted, const SoftShadow& shadow, SoftReach* reach) {
  FindReachHere(picture, buffer, rows, wanted, shadow, reach);
}
int Edges(const SoftBuffer& buffer, const uint8_t* wanted, SoftSamples* samples) {
  return FindEdgesHere(buffer, wanted, samples);
}
void Summarise(SoftShadowMap* map, SoftRows rows) { SummariseMapHere(map, rows); }
void DrawBeside(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                SoftSamples* samples) {
  DrawSamplesHere(view, instance, scratch, samples);
}
void Sum(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
         const SoftIds* colours, std::vector<SoftStray>* strays, SoftSamples* samples) {
  SumSamplesHere(picture, buffer, rows, colours, strays, samples);
}
void Means(const SoftSamples& samples, SoftRows rows, SoftIds* colours) {
  TakeMeansHere(samples, rows, colours);
}
void Pack(const SoftBuffer& buffer, SoftRows rows, const SoftIds* colours, uint8_t* rgb) {
  PackColoursHere(buffer, rows, colours, rgb);
}
void Blend(const SoftPicture& picture, const SoftBuffer& behind, const SoftBuffer& layer,
           SoftRows rows, float alpha, SoftIds* colours) {
  BlendLayerHere(picture, behind, layer, rows, alpha, colours);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {
HWY_EXPORT(Instructions);
HWY_EXPORT(Draw);
HWY_EXPORT(Exact);
HWY_EXPORT(Shade);
HWY_EXPORT(Reach);
HWY_EXPORT(Edges);
HWY_EXPORT(Summarise);
HWY_EXPORT(DrawBeside);
HWY_EXPORT(Sum);
HWY_EXPORT(Means);
HWY_EXPORT(Pack);
HWY_EXPORT(Blend);

std::string SoftInstructions() { return hwy::TargetName(HWY_DYNAMIC_DISPATCH(Instructions)()); }

namespace {

// Surfaces beyond the far plane are not nearer than this.
SoftNumbers Farthest(const SoftView& view) {
  SoftNumbers farthest;
  std::fill_n(farthest.at, kSoftPixels, view.orthographic ? 0.0f : 1 / view.far);
  return farthest;
}

SoftIds NoIds() {
  SoftIds nothing;
  std::fill_n(nothing.at, kSoftPixels, kSoftNothing);
  return nothing;
}

void Grow(const SoftInstance& instance, SoftScratch* scratch) {
  const auto grow = [](auto& row, size_t size) {
    if (row.size() < size) row.resize(size);
  };
  const size_t vertices = static_cast<size_t>(instance.mesh->vertices) + kSoftPadding,
               triangles = static_cast<size_t>(instance.mesh->triangles) + 2 * kSoftPadding;
  for (auto* row : {&scratch->x, &scratch->y, &scratch->nearness}) grow(*row, vertices);
  grow(scratch->facing, triangles);
  for (auto& row : scratch->corners) grow(row, triangles);
  grow(scratch->cut, triangles);
  grow(scratch->clusters, instance.mesh->clusters.x.size() + kSoftPadding);
  grow(scratch->groups, vertices / SoftClusters::kVertices + 2);
}

}  // namespace

void FitNearness(const SoftView& view, SoftBuffer* buffer) {
  buffer->width = view.width;
  buffer->height = view.height;
  buffer->columns = (view.width + kSoftBlock - 1) / kSoftBlock;
  buffer->rows = (view.height + kSoftBlock - 1) / kSoftBlock;
  buffer->nearness.resize(static_cast<size_t>(buffer->columns) * static_cast<size_t>(buffer->rows));
}

void FitBuffer(const SoftView& view, SoftBuffer* buffer) {
  FitNearness(view, buffer);
  buffer->ids.resize(buffer->nearness.size());
}

void ClearBlocks(const SoftView& view, std::span<const uint8_t> wanted, SoftBuffer* buffer) {
  const SoftNumbers farthest = Farthest(view);
  const SoftIds nothing = NoIds();
  for (size_t block = 0; block < wanted.size(); ++block) {
    if (!wanted[block]) continue;
    buffer->nearness[block] = farthest;
    buffer->ids[block] = nothing;
  }
}

void ClearRows(const SoftView& view, SoftRows rows, SoftBuffer* buffer) {
  const auto fill = [&](auto& of_blocks, const auto& value) {
    if (of_blocks.empty()) return;
    const auto first = of_blocks.begin();
    const ptrdiff_t columns = buffer->columns;
    std::fill(first + rows.begin * columns, first + rows.end * columns, value);
  };
  fill(buffer->nearness, Farthest(view));
  fill(buffer->ids, NoIds());
}

void DrawInstance(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                  SoftBuffer* buffer) {
  Grow(instance, scratch);
  HWY_DYNAMIC_DISPATCH(Draw)(view, instance, scratch, buffer);
}

void SummariseMap(SoftShadowMap* map, SoftRows rows) { HWY_DYNAMIC_DISPATCH(Summarise)(map, rows); }

void ReadExact(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
               std::span<float> metres, std::span<int32_t> bodies) {
  HWY_DYNAMIC_DISPATCH(Exact)
  (picture, buffer, rows, metres.empty() ? nullptr : metres.data(),
   bodies.empty() ? nullptr : bodies.data());
}

void ShadePicture(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                  const uint8_t* wanted, std::span<SoftIds> colours) {
  HWY_DYNAMIC_DISPATCH(Shade)(picture, buffer, rows, wanted, colours.data(), nullptr);
}

void ShadePicture(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                  std::span<uint8_t> rgb) {
  HWY_DYNAMIC_DISPATCH(Shade)(picture, buffer, rows, nullptr, nullptr, rgb.data());
}

void FindReach(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
               const uint8_t* wanted, const SoftShadow& shadow, std::span<SoftReach> reach) {
  HWY_DYNAMIC_DISPATCH(Reach)(picture, buffer, rows, wanted, shadow, reach.data());
}

void FindEdges(const SoftView& view, const SoftBuffer& buffer, const uint8_t* wanted,
               SoftSamples* samples) {
  samples->columns = buffer.columns;
  samples->slots.resize(buffer.ids.size());
  samples->before.resize(static_cast<size_t>(buffer.columns + 1) *
                         static_cast<size_t>(buffer.rows + 1));
  const int slots = HWY_DYNAMIC_DISPATCH(Edges)(buffer, wanted, samples);
  const size_t size = samples->At(slots, 0);
  samples->nearness.assign(size, Farthest(view));
  samples->ids.assign(size, NoIds());
  samples->red_blue.resize(static_cast<size_t>(slots));
  samples->green.resize(static_cast<size_t>(slots));
}

void DrawSamples(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                 SoftSamples* samples) {
  Grow(instance, scratch);
  HWY_DYNAMIC_DISPATCH(DrawBeside)(view, instance, scratch, samples);
}

void SumSamples(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                std::span<const SoftIds> colours, std::vector<SoftStray>* strays,
                SoftSamples* samples) {
  HWY_DYNAMIC_DISPATCH(Sum)(picture, buffer, rows, colours.data(), strays, samples);
}

void TakeMeans(const SoftSamples& samples, SoftRows rows, std::span<SoftIds> colours) {
  HWY_DYNAMIC_DISPATCH(Means)(samples, rows, colours.data());
}

void BlendLayer(const SoftPicture& picture, const SoftBuffer& behind, const SoftBuffer& layer,
                SoftRows rows, float alpha, std::span<SoftIds> colours) {
  HWY_DYNAMIC_DISPATCH(Blend)(picture, behind, layer, rows, alpha, colours.data());
}

void PackColours(const SoftBuffer& buffer, SoftRows rows, std::span<const SoftIds> colours,
                 std::span<uint8_t> rgb) {
  HWY_DYNAMIC_DISPATCH(Pack)(buffer, rows, colours.data(), rgb.data());
}

}  // namespace robocell::internal
#endif
