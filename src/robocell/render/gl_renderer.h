// The OpenGL back end of renderer.h: MuJoCo's own drawing (mjv, mjr) into an off-screen buffer, in
// a context of its own or in the drawing service of the machine (gl_canvas.h).
#pragma once

#include <memory>

#include "robocell/render/renderer.h"

namespace robocell::internal {

class GlRenderer final : public Renderer {
 public:
  // Throws Error, with everything that was tried, if there is no OpenGL on this machine.
  explicit GlRenderer(const RendererOptions& options = {});
  ~GlRenderer() override;

  void SetModel(const mjModel* model) override;
  CameraModel Render(const mjData* data, const RenderRequest& request,
                     const RenderOutputs& outputs) override;
  const RenderQuality& quality() const override;
  const std::string& description() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell::internal
