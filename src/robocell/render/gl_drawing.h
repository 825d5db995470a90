// Owners of MuJoCo's drawing objects: the abstract scene (mjvScene) and its upload to OpenGL
// (mjrContext). Internal to render/. Every function here but MjvScene's needs the GL context
// current on this thread.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <span>

#include "robocell/render/camera_model.h"
#include "robocell/render/markers.h"

namespace robocell {

class MjvScene {
 public:
  // Room for everything a model can show. Throws EngineError.
  explicit MjvScene(const mjModel* model);
  ~MjvScene() { mjv_freeScene(&scene_); }
  MjvScene(const MjvScene&) = delete;
  MjvScene& operator=(const MjvScene&) = delete;

  mjvScene* get() { return &scene_; }
  // Sees the scene through this camera from the next update on.
  void SetCamera(const CameraModel& camera);
  void Add(const Marker& marker);
  // Planes catch shadows but cast none, which nothing behind them would show: on themselves they
  // would, as speckles, because so large a surface is drawn with less precision than the shadow map
  // allows for. After every update.
  void LetPlanesCastNoShadow();

 private:
  mjvScene scene_;
};

class MjrContext {
 public:
  // Uploads the model with an off-screen buffer of this many samples per pixel; `shadow_size` 0
  // means no shadows. Without `things` it has none of the model's textures and meshes, and can draw
  // nothing that needs them.
  MjrContext(const mjModel* model, int samples, int shadow_size, bool things = true);
  ~MjrContext() { mjr_freeContext(context_.get()); }
  MjrContext(const MjrContext&) = delete;
  MjrContext& operator=(const MjrContext&) = delete;

  // Draws and reads. The buffer grows as needed and never shrinks. Rows come from the bottom, depth
  // raw and reversed.
  void Draw(mjvScene* scene, int width, int height);
  void Read(int width, int height, uint8_t* rgb, float* depth);

 private:
  void Grow(int width, int height);

  std::unique_ptr<mjrContext> context_;  // 40 kB
};

}  // namespace robocell
