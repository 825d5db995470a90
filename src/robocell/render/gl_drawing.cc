#include "robocell/render/gl_drawing.h"

#include <algorithm>

#include "robocell/mujoco/guard.h"

namespace robocell::internal {

MjrContext::MjrContext(const mjModel* model, int samples, int shadow_size, bool things)
    : context_(new mjrContext) {
  mjr_defaultContext(context_.get());
  mjModel view = *model;  // quality belongs to the renderer, and the model may be shared: change a
                          // shallow copy
  view.vis.quality.offsamples = samples;
  view.vis.quality.shadowsize = shadow_size;
  view.vis.global.offwidth = 64;
  view.vis.global.offheight = 64;
  if (!things) view.ntex = view.nmesh = view.nhfield = 0;
  try {
    Guarded("uploading the model to OpenGL", [&] {
      mjr_makeContext(&view, context_.get(), mjFONTSCALE_100);
      context_->readDepthMap = mjDEPTH_ZEROFAR;
    });
  } catch (...) {
    mjr_freeContext(context_.get());
    throw;
  }
}

void MjrContext::Grow(int width, int height) {
  mjrContext* c = context_.get();
  if (width <= c->offWidth && height <= c->offHeight) return;
  mjr_resizeOffscreen(std::max(width, c->offWidth), std::max(height, c->offHeight), c);
}

void MjrContext::Draw(mjvScene* scene, int width, int height) {
  Guarded("rendering", [&] {
    Grow(width, height);
    mjr_setBuffer(mjFB_OFFSCREEN, context_.get());
    mjr_render({0, 0, width, height}, scene, context_.get());
  });
}

void MjrContext::Read(int width, int height, uint8_t* rgb, float* depth) {
  Guarded("reading an image", [&] {
    mjr_readPixels(rgb, depth, {0, 0, width, height}, context_.get());
  });
}

}  // namespace robocell::internal
