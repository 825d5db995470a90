#include "robocell/render/scene_renderer.h"

namespace robocell {

SceneRenderer::SceneRenderer(const Scene& scene, const RendererOptions& options)
    : scene_(scene), renderer_(MakeRenderer(options)) {
  Follow();
}

CameraView SceneRenderer::Camera(std::string_view name) const {
  return NamedCamera(scene_.model(), name, "scene '" + scene_.name() + "'");
}

CameraModel SceneRenderer::Render(const RenderRequest& request, const RenderOutputs& outputs) {
  Follow();
  return renderer_->Render(scene_.data(), request, outputs);
}

void SceneRenderer::Follow() {
  const SceneNow& now = scene_.now();
  if (now.generation == generation_) return;
  renderer_->SetModel(now.model);
  generation_ = now.generation;
}

}  // namespace robocell
