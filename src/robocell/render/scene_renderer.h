// A renderer that follows its scene: when objects were added or removed, the present model is
// uploaded before the next image is drawn.
//
//   SceneRenderer renderer(scene);
//   std::vector<uint8_t> rgb(640 * 480 * 3);
//   scene.AddObject(bottle);   // model and data are new
//   renderer.Render({.camera = renderer.Camera("front"), .width = 640, .height = 480},
//                   {.rgb = rgb});
//
// Images, their content and the meaning of a request are those of render/renderer.h. It holds the
// scene like any other handle to it. Throws Renderer's errors; ClosedError once the scene was
// closed. Threads: those of the scene, one at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/scene/scene.h"

namespace robocell {

class SceneRenderer {
 public:
  // Throws NotFoundError for an unknown back end, and Error if there is no OpenGL on this machine.
  explicit SceneRenderer(const Scene& scene, const RendererOptions& options = {});

  // Returns a camera of the present scene; call it again after objects were added or removed,
  // because ids change then. Throws NotFoundError with the scene's cameras.
  CameraView Camera(std::string_view name) const;

  // Draws the present scene. Returns the camera of the drawing. Ids in the request, of cameras and
  // bodies, and those in the segmentation belong to the scene's present model.
  CameraModel Render(const RenderRequest& request, const RenderOutputs& outputs);

  const Scene& scene() const { return scene_; }
  const RenderQuality& quality() const { return renderer_->quality(); }
  const std::string& description() const { return renderer_->description(); }

 private:
  void Follow();

  Scene scene_;
  std::unique_ptr<Renderer> renderer_;
  uint64_t generation_ = 0;  // generation of the uploaded model; no scene has 0
};

}  // namespace robocell
