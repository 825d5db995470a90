#include "robocell/render/gl_renderer.h"

#include <mujoco/mujoco.h>

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/render/depth_conversion.h"
#include "robocell/render/drawn_scene.h"
#include "robocell/render/gl_canvas.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_painter.h"
#include "robocell/render/image_convert.h"
#include "robocell/render/served_canvas.h"

namespace robocell::internal {

struct GlRenderer::Impl {
  RendererOptions options;
  GlStyle style;
  const bool is_service_wanted;
  bool is_served;
  std::unique_ptr<GlCanvas> canvas;
  std::string description;
  DrawnScene drawn;
  std::vector<uint8_t> codes;
  std::vector<float> depth;  // if only millimetres are requested

  explicit Impl(const RendererOptions& chosen)
      : options(chosen),
        style{.multisamples = chosen.quality.multisamples,
              .shadow_size = chosen.quality.shadows ? chosen.quality.shadow_size : 0,
              .things = ShowsAnything(chosen.visibility)},
        is_service_wanted(IsServiceWanted()),
        is_served(is_service_wanted),
        canvas(MakeCanvas()),
        description("gl: " + canvas->description()),
        drawn({.visibility = chosen.visibility,
               .keep_unseen = chosen.quality.shadows || chosen.quality.reflections}) {}

  std::unique_ptr<GlCanvas> MakeCanvas() const {
    const GlBackend backend = GlBackendFromName(options.gl, "renderer");
    if (is_served) return std::make_unique<ServedCanvas>(backend, style);
    return std::make_unique<OwnCanvas>(backend, style);
  }

  void SetModel(const mjModel* model) {
    drawn.SetModel(model);
    try {
      const bool served = is_service_wanted && ServedCanvas::CanDraw(model);
      if (std::exchange(is_served, served) != served) canvas = MakeCanvas();
      canvas->SetModel(model);
    } catch (...) {
      drawn.Clear();
      throw;
    }
  }

  void SetFlags() {
    mjtByte* flags = drawn.scene()->flags;
    flags[mjRND_SHADOW] = options.quality.shadows;
    flags[mjRND_REFLECTION] = options.quality.reflections;
    flags[mjRND_SKYBOX] = options.visibility.skybox;
  }

  void Draw(const RenderRequest& request, const RenderOutputs& outputs, const CameraModel& camera) {
    const size_t width = static_cast<size_t>(request.width),
                 pixels = width * static_cast<size_t>(request.height);
    const bool want_depth = !outputs.depth.empty() || !outputs.depth_mm.empty();
    GlPicture picture{.scene = drawn.scene(),
                      .exact_geoms = drawn.scene()->ngeom,
                      .width = request.width,
                      .height = request.height,
                      .rgb = outputs.rgb,
                      .depth = outputs.depth};
    if (want_depth && picture.depth.empty()) picture.depth = Sized(depth, pixels);
    if (!outputs.segmentation.empty()) picture.codes = Sized(codes, 3 * pixels);
    if (picture.rgb.empty() && !picture.is_exact()) return;

    SetFlags();
    drawn.Add(request.markers);
    canvas->Paint(picture);
    picture.scene->ngeom = picture.exact_geoms;

    FlipRows(picture.rgb, 3 * width);
    if (want_depth) {
      FlipRows(picture.depth, width);
      RawDepthToMetres(picture.depth, camera);
      MetresToMillimetres(picture.depth.first(outputs.depth_mm.size()), outputs.depth_mm);
    }
    if (!picture.codes.empty()) {
      DecodeIds(picture.codes, drawn.BodyOfId(), outputs.segmentation);
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

void GlRenderer::SetModel(const mjModel* model) { impl_->SetModel(model); }

CameraModel GlRenderer::Render(const mjData* data, const RenderRequest& request,
                               const RenderOutputs& outputs) {
  RequireOutputs(request, outputs);
  CameraModel camera = impl_->drawn.Update(data, request);
  if (impl_->drawn.has_old_textures()) {
    impl_->SetModel(impl_->drawn.model());
    camera = impl_->drawn.Update(data, request);
  }
  impl_->Draw(request, outputs, camera);
  return camera;
}

}  // namespace robocell::internal
