// The software back end of renderer.h: the processor's vector registers draw triangles, without any
// graphics library. One pass gives colour, depth and segmentation.
//
// The same state gives the same bytes on any processor and any thread. soft_kernel.h describes the
// method.
#pragma once

#include <memory>

#include "robocell/render/renderer.h"
#include "robocell/render/soft_clock.h"

namespace robocell::internal {

class SoftRenderer final : public Renderer {
 public:
  explicit SoftRenderer(const RendererOptions& options = {});
  ~SoftRenderer() override;

  void SetModel(const mjModel* model) override;
  CameraModel Render(const mjData* data, const RenderRequest& request,
                     const RenderOutputs& outputs) override;
  const RenderQuality& quality() const override;
  const std::string& description() const override;

  // Clock for measurements; Render advances it.
  SoftClock& clock();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell::internal
