#include "robocell/render/soft_renderer.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "robocell/render/depth_conversion.h"
#include "robocell/render/drawn_scene.h"
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
  SoftBuffer opaque;  // surfaces that hide those behind them
  SoftBuffer all;     // buffer for depth and segmentation, with transparent elements
  SoftBuffer layer;
  internal::SoftSamples samples;
  internal::SoftReflection reflection;
  std::vector<SoftIds> colours;
  std::vector<float> depth;  // if only millimetres are requested
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
    threads.InBands(opaque.rows, [&](SoftRows rows, int band) {
      work(rows, internal::RowsOf(scene.view(), rows), threads.scratch(band));
    });
  }

  void Draw(std::span<const int> instances, const SoftView& view, SoftScratch* scratch) {
    for (const int i : instances) {
      internal::DrawInstance(view, scene.instances()[i], scratch, &opaque);
    }
  }

  void DrawOpaque() {
    internal::FitBuffer(scene.view(), &opaque);
    InBands([&](SoftRows rows, const SoftView& view, SoftScratch* scratch) {
      internal::ClearRows(view, rows, &opaque);
      Draw(scene.opaque(), view, scratch);
    });
  }

  void SmoothEdges(const SoftPicture& picture) {
    internal::FindEdges(scene.view(), opaque, &samples);
    clock.Mark(SoftStage::kEdges);
    InBands([&](SoftRows, const SoftView& view, SoftScratch* scratch) {
      for (const int i : scene.opaque()) {
        internal::DrawSamples(view, scene.instances()[i], scratch, &samples);
      }
    });
    clock.Mark(SoftStage::kSamples);
    InBands([&](SoftRows rows, const SoftView&, SoftScratch* scratch) {
      internal::SumSamples(picture, opaque, rows, colours, &scratch->strays, &samples);
    });
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::TakeMeans(samples, rows, colours);
    });
    clock.Mark(SoftStage::kSmoothing);
  }

  void DrawLayer(const internal::SoftScene::Layer& group, const SoftView& view,
                 SoftScratch* scratch, SoftBuffer* into) {
    for (int i = group.first; i < group.end; ++i) {
      internal::DrawInstance(view, scene.instances()[i], scratch, into);
    }
  }

  void DrawExact(const RenderOutputs& outputs) {
    const SoftBuffer* seen = &opaque;
    if (!scene.layers().empty()) {
      all = opaque;
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

  void DrawColour(const RenderRequest& request, std::span<uint8_t> rgb) {
    mjvScene* list = drawn.scene();
    const int geoms = list->ngeom;
    const size_t opaque_before = scene.opaque().size();
    drawn.Add(request.markers);
    scene.AddMarkers(drawn.model(), *list, geoms);
    list->ngeom = geoms;
    if (const auto marked = scene.opaque().subspan(opaque_before); !marked.empty()) {
      InBands([&](SoftRows, const SoftView& view, SoftScratch* scratch) {
        Draw(marked, view, scratch);
      });
    }
    clock.Mark(SoftStage::kTriangles);
    scene.DrawShadows(&threads);
    clock.Mark(SoftStage::kShadows);
    SoftPicture picture = scene.Picture();
    if (scene.DrawReflection(&threads, &reflection)) picture.reflection = &reflection;
    const auto layers = scene.layers();
    if (layers.empty() && samples.count == 0) {
      InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
        internal::ShadePicture(picture, opaque, rows, rgb);
      });
      clock.Mark(SoftStage::kShading);
      return;
    }
    colours.resize(opaque.ids.size());
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::ShadePicture(picture, opaque, rows, std::span<SoftIds>(colours));
    });
    clock.Mark(SoftStage::kShading);
    if (samples.count > 0) SmoothEdges(picture);
    picture.shadows = false;  // transparent elements receive none
    // Blends in the engine's order: from the front to the back, then from the back to the front.
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
    InBands([&](SoftRows rows, const SoftView&, SoftScratch*) {
      internal::PackColours(opaque, rows, colours, rgb);
    });
    clock.Mark(SoftStage::kLayers);
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
    r.drawn.TookTextures();
  }
  r.clock.Mark(SoftStage::kList);
  r.scene.Update(r.drawn.model(), *r.drawn.scene(), r.drawn.BodyOfId(), camera,
                 {.sky = r.options.visibility.skybox,
                  .shadows = quality.shadows && !outputs.rgb.empty(),
                  .reflections = quality.reflections && !outputs.rgb.empty(),
                  .shadow_size = quality.shadow_size});
  r.clock.Mark(SoftStage::kScene);
  r.DrawOpaque();
  r.clock.Mark(SoftStage::kTriangles);
  if (!outputs.depth.empty() || !outputs.depth_mm.empty() || !outputs.segmentation.empty()) {
    r.DrawExact(outputs);
    r.clock.Mark(SoftStage::kExact);
  }
  if (!outputs.rgb.empty()) r.DrawColour(request, outputs.rgb);
  return camera;
}

}  // namespace robocell::internal
