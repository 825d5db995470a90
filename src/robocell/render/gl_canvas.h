// GlCanvas: where the back end `gl` draws: in a context of its own, or in the drawing service that
// the processes of a machine share (served_canvas.h). Internal to render/.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "robocell/render/gl_context.h"
#include "robocell/render/gl_painter.h"

namespace robocell::internal {

class GlCanvas {
 public:
  virtual ~GlCanvas() = default;
  // Uploads the model, which has to live until the next call or the end.
  virtual void SetModel(const mjModel* model) = 0;
  // Returns once the images are there.
  virtual void Paint(const GlPicture& picture) = 0;
  // Returns the drawing library and device: "egl: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 ...".
  virtual const std::string& description() const = 0;
};

// Draws in a context of its own. Throws Error, with everything that was tried, if there is no
// OpenGL on this machine.
class OwnCanvas final : public GlCanvas {
 public:
  OwnCanvas(GlBackend backend, const GlStyle& style);
  ~OwnCanvas() override;

  void SetModel(const mjModel* model) override;
  void Paint(const GlPicture& picture) override;
  const std::string& description() const override { return context_->description(); }

 private:
  // Frees the objects in the GL context, which has to be current.
  void Drop() noexcept;

  GlStyle style_;
  std::unique_ptr<GlContext> context_;
  bool as_new_ = true;  // true for a context without objects of ours: no call failed in it
  // Reads colour while depth is drawn; none in software, which draws on the same processor.
  std::unique_ptr<PixelBuffer> pixels_;
  std::unique_ptr<GlPainter> painter_;
};

}  // namespace robocell::internal
