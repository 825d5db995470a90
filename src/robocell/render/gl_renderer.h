// The OpenGL back end of renderer.h: MuJoCo's own drawing (mjv, mjr) into an off-screen buffer.
//
// Colour is one pass; depth and segmentation come together from a second one, drawn with ids as
// colours, without multisampling and without the sky, which would write depth. Depth is read
// reversed (mjDEPTH_ZEROFAR), which keeps it exact to a fraction of a millimetre over the whole
// range.
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
