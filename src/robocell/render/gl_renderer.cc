#include "robocell/render/gl_renderer.h"

#include <mujoco/mujoco.h>

#include <utility>

#include "robocell/base/error.h"
#include "robocell/render/depth_conversion.h"
#include "robocell/render/drawn_scene.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_drawing.h"
#include "robocell/render/image_convert.h"

namespace robocell::internal {

struct GlRenderer::Impl {
  RendererOptions options;
  std::unique_ptr<GlContext> context;
  bool as_new = true;  // true for a context without objects of ours: no call failed in it
  std::string description;
  DrawnScene drawn;
  std::unique_ptr<MjrContext> colour;  // uploads; without multisampling one serves both passes
  std::unique_ptr<MjrContext> exact;   // for depth and segmentation if `colour` is multisampled
  std::vector<uint8_t> ids_rgb;
  std::vector<float> depth;  // if only millimetres are requested

  explicit Impl(const RendererOptions& chosen)
      : options(chosen),
        context(GlContext::Create(GlBackendFromName(chosen.gl, "renderer"))),
        description("gl: " + context->description()),
        drawn({.visibility = chosen.visibility,
               .keep_unseen = chosen.quality.shadows || chosen.quality.reflections}) {}

  ~Impl() {
    Drop();
    if (as_new) GlContext::GiveBack(std::move(context));
  }

  // Frees the objects in the GL context, which has to be current.
  void Drop() noexcept {
    if (!colour && !exact) return;
    try {
      GlContext::Current current(*context);
      colour.reset();
      exact.reset();
    } catch (const Error&) {  // a context in use elsewhere frees them at its end
      static_cast<void>(colour.release());
      static_cast<void>(exact.release());
      as_new = false;
    }
  }

  MjrContext& Exact() {
    if (options.quality.multisamples == 0) return *colour;
    if (!exact) {
      exact = std::make_unique<MjrContext>(drawn.model(), 0, 0, ShowsAnything(options.visibility));
    }
    return *exact;
  }

  void SetFlags(bool ids) {
    mjtByte* flags = drawn.scene()->flags;
    flags[mjRND_SEGMENT] = flags[mjRND_IDCOLOR] = ids;
    flags[mjRND_SHADOW] = options.quality.shadows;
    flags[mjRND_REFLECTION] = options.quality.reflections;
    flags[mjRND_SKYBOX] = options.visibility.skybox;
  }

  void DrawColour(const RenderRequest& request, std::span<uint8_t> rgb) {
    mjvScene* scene = drawn.scene();
    const int geoms = scene->ngeom;
    drawn.Add(request.markers);
    SetFlags(false);
    colour->Draw(scene, request.width, request.height);
    colour->Read(request.width, request.height, rgb.data(), nullptr);
    FlipRows(rgb, 3 * static_cast<size_t>(request.width));
    scene->ngeom = geoms;
  }

  void DrawExact(const RenderRequest& request, const RenderOutputs& outputs,
                 const CameraModel& camera) {
    const size_t width = static_cast<size_t>(request.width),
                 pixels = width * static_cast<size_t>(request.height);
    const bool want_depth = !outputs.depth.empty() || !outputs.depth_mm.empty();
    std::span<float> metres = outputs.depth;
    if (want_depth && metres.empty()) metres = Sized(depth, pixels);
    const bool want_ids = !outputs.segmentation.empty();
    std::span<uint8_t> codes = want_ids ? Sized(ids_rgb, 3 * pixels) : std::span<uint8_t>();

    SetFlags(true);
    Exact().Draw(drawn.scene(), request.width, request.height);
    Exact().Read(request.width, request.height, want_ids ? codes.data() : nullptr,
                 want_depth ? metres.data() : nullptr);
    if (want_depth) {
      FlipRows(metres, width);
      RawDepthToMetres(metres, camera);
      MetresToMillimetres(metres.first(outputs.depth_mm.size()), outputs.depth_mm);
    }
    if (want_ids) {
      DecodeIds(codes, drawn.BodyOfId(), outputs.segmentation);
      FlipRows(outputs.segmentation, width);
    }
  }

  template <class T>
  static std::span<T> Sized(std::vector<T>& buffer, size_t size) {
    if (buffer.size() < size) buffer.resize(size);
    return std::span<T>(buffer).first(size);
  }
};

GlRenderer::GlRenderer(const RendererOptions& options) : impl_(std::make_unique<Impl>(options)) {}

GlRenderer::~GlRenderer() = default;

const RenderQuality& GlRenderer::quality() const { return impl_->options.quality; }

const std::string& GlRenderer::description() const { return impl_->description; }

void GlRenderer::SetModel(const mjModel* model) {
  Impl& r = *impl_;
  r.Drop();
  r.drawn.SetModel(model);
  const RenderQuality& quality = r.options.quality;
  try {
    GlContext::Current current(*r.context);
    const bool as_new = std::exchange(r.as_new, false);
    r.colour = std::make_unique<MjrContext>(model, quality.multisamples,
                                            quality.shadows ? quality.shadow_size : 0,
                                            ShowsAnything(r.options.visibility));
    r.as_new = as_new;
  } catch (...) {
    r.drawn.Clear();
    throw;
  }
}

CameraModel GlRenderer::Render(const mjData* data, const RenderRequest& request,
                               const RenderOutputs& outputs) {
  Impl& r = *impl_;
  RequireOutputs(request, outputs);
  CameraModel camera = r.drawn.Update(data, request);
  GlContext::Current current(*r.context);
  const bool as_new = std::exchange(r.as_new, false);
  if (!outputs.rgb.empty()) r.DrawColour(request, outputs.rgb);
  if (!outputs.depth.empty() || !outputs.depth_mm.empty() || !outputs.segmentation.empty()) {
    r.DrawExact(request, outputs, camera);
  }
  r.as_new = as_new;
  return camera;
}

}  // namespace robocell::internal
