// Owner of a model's upload to OpenGL (mjrContext). Internal to render/. Every function here needs
// the GL context current on this thread.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>

namespace robocell::internal {

class MjrContext {
 public:
  // Uploads the model with an off-screen buffer of this many samples per pixel; `shadow_size` 0
  // means no shadows. Without `things` the upload lacks the model's textures and meshes, and cannot
  // draw elements that need them.
  MjrContext(const mjModel* model, int samples, int shadow_size, bool things = true);
  ~MjrContext() { mjr_freeContext(context_.get()); }
  MjrContext(const MjrContext&) = delete;
  MjrContext& operator=(const MjrContext&) = delete;

  // Draws and reads. The buffer grows as needed and never shrinks. Rows come from the bottom, depth
  // is raw and reversed.
  void Draw(mjvScene* scene, int width, int height);
  void Read(int width, int height, uint8_t* rgb, float* depth);

 private:
  void Grow(int width, int height);

  std::unique_ptr<mjrContext> context_;  // 40 kB
};

}  // namespace robocell::internal
