// Renderer: images of a simulation's state. An interface, so that back ends can be exchanged at run
// time.
//
// Images are rows from the top, pixels from the left, without padding:
//   rgb            3 bytes a pixel, sRGB
//   depth          float metres along the camera's axis (distance to its plane, not along the ray);
//                  0 where nothing is
//   depth_mm       the same in whole millimetres, at most 65535; 0 where nothing is
//   segmentation   id of the body that is seen (0: the world's own geoms, e.g. the floor), -1 where
//                  nothing is and for elements without a body (tendons, flexes, skins)
//
//   std::unique_ptr<Renderer> renderer = MakeRenderer({.backend = "soft"});
//   renderer->SetModel(model);                                      // again after every compile
//   const CameraView view = NamedCamera(model, "wrist", "robot 'left'");
//   std::vector<uint8_t> rgb(640 * 480 * 3);
//   const CameraModel camera =
//       renderer->Render(data, {.camera = view, .width = 640, .height = 480}, {.rgb = rgb});
//
// The drawing follows qpos and the mocap poses in `data`; poses are recomputed in the renderer's
// own scratch data, so that images are never a step behind (the engine's poses are, after mj_step)
// and `data` is only read. Colours, sizes and lights are read from the model at each call; meshes
// and textures in SetModel. The same state, model and renderer give the same bytes, independent of
// earlier renderings and of the thread.
//
// Lifetime: the model must live until the next SetModel or the end of the renderer; that of a scene
// ends when objects are added or removed, which render/scene_renderer.h follows. Throws
// ArgumentError for buffers of the wrong size, data of another model and a freed model (of a
// ModelPtr or a scene), EngineError, and Error if there is no OpenGL. Threads: one at a time, any.
// No allocation of ours once the largest image has been rendered.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/markers.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

struct RenderRequest {
  CameraView camera = OrbitCamera{};
  int width = 320, height = 240;
  std::span<const Marker> markers = {};  // colour only
};

// The caller's buffers; an empty one skips its image.
struct RenderOutputs {
  std::span<uint8_t> rgb = {};
  std::span<float> depth = {};
  std::span<uint16_t> depth_mm = {};
  std::span<int32_t> segmentation = {};
};

// Visible elements of the model, in all kinds of images.
struct Visibility {
  std::array<bool, 6> geom_groups = {true,  true,  true,
                                     false, false, false};  // 3 and up: collision geoms, by custom
  bool sites = false;                                       // reference points, no matter
  bool skybox = true;
};

struct RendererOptions {
  std::string backend = "auto";  // or one of RendererBackends() (render/renderer_backends.h)
  std::string gl = "auto";       // OpenGL of backend gl: auto, egl, osmesa (render/gl_context.h)
  // Shadows, reflections and multisampling are off by default: on a CPU they cost up to 19 times
  // the rest.
  RenderQuality quality = {};
  Visibility visibility = {};
  // Threads that share an image with back end soft; 0 means one per core. Several pay off for large
  // images. The images are identical.
  int threads = 1;
};

class Renderer {
 public:
  virtual ~Renderer() = default;

  // Uploads meshes and textures. Required again for a recompiled model, even at the same address.
  virtual void SetModel(const mjModel* model) = 0;
  // Returns the camera of the drawing: intrinsics and extrinsics of exactly these images.
  virtual CameraModel Render(const mjData* data, const RenderRequest& request,
                             const RenderOutputs& outputs) = 0;

  // Return the present settings and a description of the renderer, for records: e.g. "gl: egl:
  // llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 ...".
  virtual const RenderQuality& quality() const = 0;
  virtual const std::string& description() const = 0;
};

// Returns names for RendererOptions::backend.
std::vector<std::string> RendererBackends();

// Throws NotFoundError for an unknown back end, and Error if it does not work on this machine.
// "auto" takes the one in ROBOCELL_RENDERER, else gl, or soft without OpenGL.
std::unique_ptr<Renderer> MakeRenderer(const RendererOptions& options = {});

// Throws ArgumentError for an image without pixels, or too large for every back end.
void RequireImageSize(int width, int height);

// Throws ArgumentError unless each buffer is empty or holds exactly one image; for back ends.
void RequireOutputs(const RenderRequest& request, const RenderOutputs& outputs);

}  // namespace robocell
