// A renderer that follows its scene: when objects were added or removed, the present model is
// uploaded before the next image is drawn.
//
//   SceneRenderer renderer(scene);
//   std::vector<uint8_t> rgb(640 * 480 * 3);
//   scene.AddObject(bottle);   // model and data are new
//   renderer.Render({.camera = renderer.Camera("front"), .width = 640, .height = 480},
//                   {.rgb = rgb});
//
// Images, what is drawn and the meaning of a request are those of render/renderer.h. It holds the
// scene like any other handle to it. Errors: Renderer's; ClosedError once the scene was closed.
// Threads: those of the scene, one at a time.
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
  // NotFoundError for an unknown back end; Error when there is no OpenGL on this machine.
  explicit SceneRenderer(const Scene& scene, const RendererOptions& options = {});

  // A camera of the scene as it is now; ask again when objects were added or removed, as ids change
  // then. NotFoundError with the scene's cameras.
  CameraView Camera(std::string_view name) const;

  // The scene as it is now. Returns the camera that was drawn with. Ids in the request, of cameras
  // and bodies, and those in the segmentation are of the scene's present model.
  CameraModel Render(const RenderRequest& request, const RenderOutputs& outputs);

  const Scene& scene() const { return scene_; }
  const RenderQuality& quality() const { return renderer_->quality(); }
  const std::string& description() const { return renderer_->description(); }

 private:
  void Follow();

  Scene scene_;
  std::unique_ptr<Renderer> renderer_;
  uint64_t generation_ = 0;  // that was uploaded; no scene has 0
};

}  // namespace robocell
