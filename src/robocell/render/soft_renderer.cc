#include "robocell/render/soft_renderer.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "robocell/render/depth_conversion.h"
#include "robocell/render/drawn_scene.h"
#include "robocell/render/soft_kept.h"
#include "robocell/render/soft_kernel.h"
#include "robocell/render/soft_scene.h"
#include "robocell/render/soft_threads.h"

namespace robocell::internal {

namespace {

// The positions of samples in a pixel: no two in a row or a column, so that edges of any slope are
// smoothed.
internal::SoftSamples Samples(int wanted) {
  internal::SoftSamples samples;
  if (wanted <= 1) return samples;
  const int count = wanted <= 4 ? 4 : wanted <= 8 ? 8 : 16;
  // Columns of the rows, from the top; steps of 1 / count from the left edge.
  static constexpr int kFour[] = {1, 3, 0, 2}, kEight[] = {3, 6, 1, 4, 7, 2, 5, 0},
                       kSixteen[] = {7, 2, 12, 5, 15, 9, 0, 11, 4, 14, 6, 1, 10, 13, 3, 8};
  static_assert(std::size(kSixteen) == internal::kSoftMostSamples);
  const int* columns = count == 4 ? kFour : count == 8 ? kEight : kSixteen;
  const auto place = [&](int step) {
    return (static_cast<float>(step) + 0.5f) / static_cast<float>(count) - 0.5f;
  };
  samples.count = count;
  for (int i = 0; i < count; ++i) {
    samples.right[i] = place(columns[i]);
    samples.down[i] = place(i);
  }
  return samples;
}

}  // namespace

struct SoftRenderer::Impl {
  RendererOptions options;
  std::string description;
  DrawnScene drawn;
  internal::SoftScene scene;
  internal::SoftThreads threads;
  SoftPictures pictures;  // with the surfaces that hide those behind them
  SoftBuffer part;        // buffer for what has changed
  SoftBuffer all;         // buffer for depth and segmentation, with transparent elements
  SoftBuffer layer;
  internal::SoftSamples samples;
  internal::SoftReflection reflection;
  std::vector<SoftIds> blended;  // colours with transparent elements
  std::vector<float> depth;      // if only millimetres are requested
  SoftClock clock;

  explicit Impl(const RendererOptions& chosen)
      : options(chosen),
        description("soft: " + internal::SoftInstructions()),
        drawn({.visibility = chosen.visibility,
               .keep_unseen = chosen.quality.shadows || chosen.quality.reflections}),
        threads(chosen.threads),
        samples(Samples(chosen.quality.multisamples)) {}

  // Calls work(rows, view of these rows, scratch memory) for bands of the image.
  template <class Work>
  void InBands(const Work& work) {
    InBands(BlockRows(scene.view()), work);
  }
  template <class Work>
  void InBands(SoftRows all_rows, const Work& work) {
    threads.InBands(all_rows.end - all_rows.begin, [&](SoftRows rows, int band) {
      rows = {all_rows.begin + rows.begin, all_rows.begin + rows.end};
      work(rows, internal::RowsOf(scene.view(), rows), threads.scratch(band));
    });
  }

  void Draw(std::span<const int> instances, const SoftView& view, SoftScratch* scratch,
            SoftBuffer* buffer) {
    for (const int i : instances) {
      internal::DrawInstance(view, scene.instances()[i], scratch, buffer);
    }
  }

  void DrawOpaque(SoftKept* kept) {
    internal::FitBuffer(scene.view(), &kept->buffer);
    InBands([&](SoftRows rows, const SoftView& view, SoftScratch* scratch) {
      internal::ClearRows(view, rows, &kept->buffer);
      Draw(scene.opaque(), view, scratch, &kept->buffer);
    });
  }

  // So that later pictures allocate nothing.
  void ReservePart(bool may_keep, const SoftBuffer& buffer) {
    if (!may_keep) return;
    part.nearness.reserve(buffer.nearness.size());
    part.ids.reserve(buffer.ids.size());
    if (!scene.layers().empty()) blended.reserve(buffer.ids.size());
  }

  // Draws everything that meets a touched block into a buffer of which only these blocks count: of
  // triangles at one place the last one is visible, so that all of them must be drawn.
  void DrawTouched(SoftKept* kept) {
    const SoftRows rows = kept->touched_rows();
    if (rows.begin >= rows.end) return;
    internal::FitBuffer(scene.view(), &part);
    internal::ClearBlocks(scene.view(), kept->touched(), &part);
    InBands(rows, [&](SoftRows, const SoftView& view, SoftScratch* scratch) {
      for (const int i : scene.opaque()) {
        if (!kept->Touches(static_cast<size_t>(i))) continue;
        internal::DrawInstance(view, scene.instances()[i], scratch, &part);
      }
    });
    kept->TakeSurfaces(scene.Picture(), part);
  }

  // Returns true if something of the instance may lie in a block with samples.
  bool MeetsSamples(const SoftKept& kept, int instance) const {
    if (kept.way() != SoftKept::Way::kParts) return true;
    const SoftBlocks& place = kept.PlaceOf(static_cast<size_t>(instance));
    const auto before = [&](int x, int y) {
      return samples.before[static_cast<size_t>(y) * static_cast<size_t>(samples.columns + 1) +
                            static_cast<size_t>(x)];
    };
    return before(place.end[0], place.end[1]) - before(place.begin[0], place.end[1]) !=
           before(place.end[0], place.begin[1]) - before(place.begin[0], place.begin[1]);
  }

  // Returns the smooth colours.
  std::span<SoftIds> SmoothEdges(const SoftPicture& picture, SoftKept* kept) {
    const bool once = kept->way() == SoftKept::Way::kOnce;
    internal::FindEdges(scene.view(), kept->buffer, kept->smoothed(), &samples);
    clock.Mark(SoftStage::kEdges);
    InBands([&](SoftRows, const SoftView& view, SoftScratch* scratch) {
      for (const int i : scene.opaque()) {
        if (!MeetsSamples(*kept, i)) continue;
        internal::DrawSamples(view, scene.instances()[i], scratch, &samples);
      }
    });
    clock.Mark(SoftStage::kSamples);
    if (!once) kept->BeginStrays(samples.red_blue.size());
    InBands([&](SoftRows rows, const SoftView&, SoftScratch* scratch) {
      internal::SumSamples(picture, kept->buffer, rows, kept->colours, &scratch->strays, &samples);
      if (!once) kept->MarkStrays(scratch->strays);
    });
    if (!once) {
      kept->EndStrays(samples);
      kept->BeginSmoothing();
    }
    const std::span<SoftIds> smooth = once ? kept->colours : kept->smooth;
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::TakeMeans(samples, rows, smooth);
    });
    clock.Mark(SoftStage::kSmoothing);
    return smooth;
  }

  void DrawLayer(const internal::SoftScene::Layer& group, const SoftView& view,
                 SoftScratch* scratch, SoftBuffer* into) {
    for (int i = group.first; i < group.end; ++i) {
      internal::DrawInstance(view, scene.instances()[i], scratch, into);
    }
  }

  void DrawExact(const RenderOutputs& outputs, const SoftKept& kept) {
    const SoftBuffer* seen = &kept.buffer;
    if (!scene.layers().empty()) {
      all = kept.buffer;
      InBands([&](SoftRows, const SoftView& view, SoftScratch* scratch) {
        for (const auto& group : scene.layers()) DrawLayer(group, view, scratch, &all);
      });
      seen = &all;
    }
    std::span<float> metres = outputs.depth;
    if (metres.empty() && !outputs.depth_mm.empty()) {
      depth.resize(outputs.depth_mm.size());
      metres = depth;
    }
    const SoftPicture picture = scene.Picture();
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::ReadExact(picture, *seen, rows, metres, outputs.segmentation);
    });
    MetresToMillimetres(metres.first(outputs.depth_mm.size()), outputs.depth_mm);
  }

  void AddMarkers(std::span<const Marker> markers, SoftKept* kept) {
    mjvScene* list = drawn.scene();
    const int geoms = list->ngeom;
    const size_t opaque_before = scene.opaque().size();
    drawn.Add(markers);
    scene.AddMarkers(drawn.model(), *list, geoms);
    list->ngeom = geoms;
    if (const auto marked = scene.opaque().subspan(opaque_before); !marked.empty()) {
      InBands([&](SoftRows, const SoftView& view, SoftScratch* scratch) {
        Draw(marked, view, scratch, &kept->buffer);
      });
    }
  }

  void DrawColour(const RenderRequest& request, std::span<uint8_t> rgb, SoftKept* kept) {
    if (!request.markers.empty()) AddMarkers(request.markers, kept);
    clock.Mark(SoftStage::kTriangles);
    scene.DrawShadows(&threads);
    clock.Mark(SoftStage::kShadows);
    SoftPicture picture = scene.Picture();
    if (scene.DrawReflection(&threads, &reflection)) picture.reflection = &reflection;
    const auto layers = scene.layers();
    const bool once = kept->way() == SoftKept::Way::kOnce;
    if (once && layers.empty() && samples.count == 0) {
      InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
        internal::ShadePicture(picture, kept->buffer, rows, rgb);
      });
      clock.Mark(SoftStage::kShading);
      return;
    }
    kept->FindColours(picture);
    kept->colours.resize(kept->buffer.ids.size());
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::ShadePicture(picture, kept->buffer, rows, kept->changed(), kept->colours);
    });
    clock.Mark(SoftStage::kShading);
    std::span<SoftIds> colours = kept->colours;
    if (samples.count > 0) colours = SmoothEdges(picture, kept);
    if (!layers.empty()) {
      if (!once) {
        blended.assign(colours.begin(), colours.end());
        colours = blended;
      }
      BlendLayers(picture, kept->buffer, colours);
    }
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::PackColours(kept->buffer, rows, colours, rgb);
    });
    clock.Mark(SoftStage::kLayers);
  }

  // Blends in the engine's order: from the front to the back, then from the back to the front.
  void BlendLayers(SoftPicture picture, const SoftBuffer& opaque, std::span<SoftIds> colours) {
    picture.shadows = false;  // transparent elements receive none
    const auto layers = scene.layers();
    const auto blend = [&](const internal::SoftScene::Layer& group) {
      internal::FitBuffer(scene.view(), &layer);
      InBands([&](SoftRows rows, const SoftView& view, SoftScratch* scratch) {
        internal::ClearRows(view, rows, &layer);
        DrawLayer(group, view, scratch, &layer);
        internal::BlendLayer(picture, opaque, layer, rows, group.alpha, colours);
      });
    };
    for (auto group = layers.begin(); group != layers.end(); ++group) blend(*group);
    for (auto group = layers.rbegin(); group != layers.rend(); ++group) blend(*group);
  }
};

SoftRenderer::SoftRenderer(const RendererOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}

SoftRenderer::~SoftRenderer() = default;

const RenderQuality& SoftRenderer::quality() const { return impl_->options.quality; }

SoftClock& SoftRenderer::clock() { return impl_->clock; }

const std::string& SoftRenderer::description() const { return impl_->description; }

void SoftRenderer::SetModel(const mjModel* model) {
  Impl& r = *impl_;
  r.pictures.Forget();  // they point into the assets
  r.drawn.SetModel(model);
  r.scene.SetModel(model, r.options.visibility);
}

CameraModel SoftRenderer::Render(const mjData* data, const RenderRequest& request,
                                 const RenderOutputs& outputs) {
  Impl& r = *impl_;
  RequireOutputs(request, outputs);
  const RenderQuality& quality = r.options.quality;
  r.clock.Begin();
  const CameraModel camera = r.drawn.Update(data, request);
  if (r.drawn.has_old_textures()) {
    r.scene.TakeTextures(r.drawn.model());
    r.pictures.Forget();
    r.drawn.TookTextures();
  }
  r.clock.Mark(SoftStage::kList);
  r.scene.Update(r.drawn.model(), *r.drawn.scene(), r.drawn.BodyOfId(), camera,
                 {.sky = r.options.visibility.skybox,
                  .shadows = quality.shadows && !outputs.rgb.empty(),
                  .reflections = quality.reflections && !outputs.rgb.empty(),
                  .shadow_size = quality.shadow_size});
  r.clock.Mark(SoftStage::kScene);
  const bool colour = !outputs.rgb.empty();
  SoftKept& kept = r.pictures.Of(request, camera, colour);
  const bool may_keep =
      request.markers.empty() && !r.scene.has_mirror() && SoftPictures::Keeps(camera);
  if (kept.Begin(r.scene, camera, may_keep, colour) == SoftKept::Way::kParts) {
    r.DrawTouched(&kept);
  } else {
    r.DrawOpaque(&kept);
    r.ReservePart(may_keep, kept.buffer);
  }
  r.clock.Mark(SoftStage::kTriangles);
  if (!outputs.depth.empty() || !outputs.depth_mm.empty() || !outputs.segmentation.empty()) {
    r.DrawExact(outputs, kept);
    r.clock.Mark(SoftStage::kExact);
  }
  if (colour) r.DrawColour(request, outputs.rgb, &kept);
  kept.End();
  return camera;
}

}  // namespace robocell::internal
