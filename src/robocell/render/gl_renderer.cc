#include "robocell/render/gl_renderer.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_drawing.h"
#include "robocell/render/image_convert.h"
#include "robocell/render/pedestal_feet.h"
#include "robocell/render/view_cull.h"

namespace robocell {
namespace {

bool ShowsAnything(const Visibility& visibility) {
  const auto& groups = visibility.geom_groups;
  return visibility.sites || visibility.skybox ||
         std::find(groups.begin(), groups.end(), true) != groups.end();
}

mjvOption ToOption(const Visibility& visibility) {
  mjvOption option;
  mjv_defaultOption(&option);
  for (int i = 0; i < mjNGROUP; ++i) option.geomgroup[i] = visibility.geom_groups[i];
  if (!visibility.sites) std::fill_n(option.sitegroup, mjNGROUP, mjtByte{0});
  if (!ShowsAnything(visibility)) {
    std::fill_n(option.skingroup, mjNGROUP, mjtByte{0});
    std::fill_n(option.flexgroup, mjNGROUP, mjtByte{0});
  }
  option.flags[mjVIS_RANGEFINDER] = 0;  // drawn rays are no matter
  return option;
}

// The body that a drawn thing belongs to, -1 for none.
int BodyOf(const mjModel* model, const mjvGeom& geom) {
  if (geom.objtype == mjOBJ_GEOM) return model->geom_bodyid[geom.objid];
  if (geom.objtype == mjOBJ_SITE) return model->site_bodyid[geom.objid];
  return -1;
}

}  // namespace

struct GlRenderer::Impl {
  RendererOptions options;
  std::unique_ptr<GlContext> context;
  bool as_new = true;  // the context is when nothing of ours is in it: no call failed in there
  std::string description;
  mjvOption visible;

  const mjModel* model = nullptr;
  ModelWatch watch;        // of the model, which is the caller's
  uint64_t signature = 0;  // the model's, which its data have too
  DataPtr scratch;         // poses for drawing
  std::unique_ptr<MjvScene> scene;
  ViewCull cull;
  PedestalFeet feet;
  int ids = 0;  // segmentation ids of the present scene, also of what is out of view
  std::unique_ptr<MjrContext> colour;  // uploads; without multisampling one serves both passes
  std::unique_ptr<MjrContext> exact;   // for depth and segmentation, when `colour` is multisampled
  std::vector<uint8_t> ids_rgb;
  std::vector<float> depth;  // when only millimetres are wanted
  std::vector<int32_t> body_of_id;

  ~Impl() {
    Drop();
    if (as_new) GlContext::GiveBack(std::move(context));
  }

  // Frees what lives in the GL context, which has to be current for that.
  void Drop() noexcept {
    if (!colour && !exact) return;
    try {
      GlContext::Current current(*context);
      colour.reset();
      exact.reset();
    } catch (const Error&) {  // the context is in use elsewhere: its objects go when it does
      static_cast<void>(colour.release());
      static_cast<void>(exact.release());
      as_new = false;
    }
  }

  // Whether it may be drawn at all. Reads nothing of the model, which may have been freed.
  void Check(const mjData* data) const {
    if (!model) throw ArgumentError("renderer: no model; call SetModel before Render");
    if (watch.gone()) {
      throw ArgumentError(
          "renderer: the model that it was given was freed; call SetModel after a scene was built "
          "anew, or draw with a SceneRenderer");
    }
    if (data->signature != signature) {
      throw ArgumentError(
          "renderer: the data belong to another model; call SetModel after a scene was built anew");
    }
  }

  MjrContext& Exact() {
    if (options.quality.multisamples == 0) return *colour;
    if (!exact)
      exact = std::make_unique<MjrContext>(model, 0, 0, ShowsAnything(options.visibility));
    return *exact;
  }

  void UpdatePoses(const mjModel& view, const mjData* data) {
    mju_copy(scratch->qpos, data->qpos, static_cast<int>(model->nq));
    mju_copy(scratch->mocap_pos, data->mocap_pos, static_cast<int>(3 * model->nmocap));
    mju_copy(scratch->mocap_quat, data->mocap_quat, static_cast<int>(4 * model->nmocap));
    scratch->time = data->time;
    Guarded("computing poses for an image", scratch.get(),
            [&] { mj_fwdKinematics(&view, scratch.get()); });
  }

  void UpdateScene(const mjModel& view, const CameraModel& camera) {
    scene->SetCamera(camera);
    mjvCamera user;
    mjv_defaultCamera(&user);
    user.type = mjCAMERA_USER;  // the camera set above stays
    Guarded("preparing an image", scratch.get(), [&] {
      mjv_updateScene(&view, scratch.get(), &visible, nullptr, &user, mjCAT_STATIC | mjCAT_DYNAMIC,
                      scene->get());
    });
    scene->LetPlanesCastNoShadow();
    Guarded("preparing an image", scratch.get(),
            [&] { feet.ReachDown(&view, scratch.get(), visible, scene->get()); });
    ids = scene->get()->ngeom;
    const RenderQuality& quality = options.quality;
    if (!quality.shadows && !quality.reflections) cull.DropUnseen(camera, scene->get());
  }

  void SetFlags(bool ids) {
    mjtByte* flags = scene->get()->flags;
    flags[mjRND_SEGMENT] = flags[mjRND_IDCOLOR] = ids;
    flags[mjRND_SHADOW] = options.quality.shadows;
    flags[mjRND_REFLECTION] = options.quality.reflections;
    flags[mjRND_SKYBOX] = options.visibility.skybox;
  }

  void DrawColour(const RenderRequest& request, std::span<uint8_t> rgb) {
    mjvScene* drawn = scene->get();
    const int geoms = drawn->ngeom;
    for (const Marker& marker : request.markers) scene->Add(marker);
    SetFlags(false);
    colour->Draw(drawn, request.width, request.height);
    colour->Read(request.width, request.height, rgb.data(), nullptr);
    FlipRows(rgb, 3 * static_cast<size_t>(request.width));
    drawn->ngeom = geoms;
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
    Exact().Draw(scene->get(), request.width, request.height);
    Exact().Read(request.width, request.height, want_ids ? codes.data() : nullptr,
                 want_depth ? metres.data() : nullptr);
    if (want_depth) {
      FlipRows(metres, width);
      RawDepthToMetres(metres, camera);
      MetresToMillimetres(metres.first(outputs.depth_mm.size()), outputs.depth_mm);
    }
    if (want_ids) {
      DecodeIds(codes, BodyTable(), outputs.segmentation);
      FlipRows(outputs.segmentation, width);
    }
  }

  // Body of each segmentation id of the present scene.
  std::span<const int32_t> BodyTable() {
    const mjvScene* drawn = scene->get();
    std::span<int32_t> table = Sized(body_of_id, static_cast<size_t>(ids));
    std::fill(table.begin(), table.end(), -1);
    for (int i = 0; i < drawn->ngeom; ++i) {
      const mjvGeom& geom = drawn->geoms[i];
      if (geom.segid >= 0 && geom.segid < ids) table[geom.segid] = BodyOf(model, geom);
    }
    return table;
  }

  template <class T>
  static std::span<T> Sized(std::vector<T>& buffer, size_t size) {
    if (buffer.size() < size) buffer.resize(size);
    return std::span<T>(buffer).first(size);
  }
};

GlRenderer::GlRenderer(const RendererOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->context = GlContext::Create(GlBackendFromName(options.gl, "renderer"));
  impl_->description = "gl: " + impl_->context->description();
  impl_->visible = ToOption(options.visibility);
}

GlRenderer::~GlRenderer() = default;

const RenderQuality& GlRenderer::quality() const { return impl_->options.quality; }

const std::string& GlRenderer::description() const { return impl_->description; }

void GlRenderer::SetModel(const mjModel* model) {
  Impl& r = *impl_;
  r.Drop();
  r.model = nullptr;
  r.scratch = MakeData(model);
  r.scene = std::make_unique<MjvScene>(model);
  r.cull = ViewCull(model);
  r.feet = PedestalFeet(model);
  const RenderQuality& quality = r.options.quality;
  GlContext::Current current(*r.context);
  const bool as_new = std::exchange(r.as_new, false);
  r.colour = std::make_unique<MjrContext>(model, quality.multisamples,
                                          quality.shadows ? quality.shadow_size : 0,
                                          ShowsAnything(r.options.visibility));
  r.watch = ModelWatch(model);
  r.signature = model->signature;
  r.model = model;
  r.as_new = as_new;
}

CameraModel GlRenderer::Render(const mjData* data, const RenderRequest& request,
                               const RenderOutputs& outputs) {
  Impl& r = *impl_;
  CheckOutputs(request, outputs);
  r.Check(data);
  mjModel view = *r.model;  // shallow; the engine does not update bodies that sleep, which in the
                            // scratch data are stale
  view.opt.enableflags &= ~mjENBL_SLEEP;
  r.UpdatePoses(view, data);
  CameraModel camera =
      ComputeCamera(r.model, r.scratch.get(), request.camera, request.width, request.height);
  r.UpdateScene(view, camera);
  GlContext::Current current(*r.context);
  const bool as_new = std::exchange(r.as_new, false);
  if (!outputs.rgb.empty()) r.DrawColour(request, outputs.rgb);
  if (!outputs.depth.empty() || !outputs.depth_mm.empty() || !outputs.segmentation.empty()) {
    r.DrawExact(request, outputs, camera);
  }
  r.as_new = as_new;
  return camera;
}

}  // namespace robocell
