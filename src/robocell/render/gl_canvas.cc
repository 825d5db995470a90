#include "robocell/render/gl_canvas.h"

#include <utility>

#include "robocell/base/error.h"
#include "robocell/render/egl_devices.h"

namespace robocell::internal {

OwnCanvas::OwnCanvas(GlBackend backend, const GlStyle& style)
    : style_(style), context_(GlContext::Create(backend)) {}

OwnCanvas::~OwnCanvas() {
  Drop();
  if (as_new_) GlContext::GiveBack(std::move(context_));
}

void OwnCanvas::Drop() noexcept {
  if (!painter_) return;
  try {
    GlContext::Current current(*context_);
    painter_.reset();
    pixels_.reset();
  } catch (const Error&) {  // a context in use elsewhere frees them at its end
    static_cast<void>(painter_.release());
    static_cast<void>(pixels_.release());
    as_new_ = false;
  }
}

void OwnCanvas::SetModel(const mjModel* model) {
  Drop();
  GlContext::Current current(*context_);
  const bool as_new = std::exchange(as_new_, false);
  painter_ = std::make_unique<GlPainter>(model, style_);
  if (!IsSoftwareRenderer(description())) pixels_ = std::make_unique<PixelBuffer>(*context_);
  as_new_ = as_new;
}

void OwnCanvas::Paint(const GlPicture& picture) {
  GlContext::Current current(*context_);
  const bool as_new = std::exchange(as_new_, false);
  if (pixels_ && !picture.rgb.empty() && picture.is_exact()) {
    painter_->Begin(picture, *pixels_);
    GlPainter::Finish(picture, *pixels_);
  } else {
    painter_->Paint(picture);
  }
  as_new_ = as_new;
}

}  // namespace robocell::internal
