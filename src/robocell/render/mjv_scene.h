// Owner of MuJoCo's abstract scene (mjvScene): a list of what is to be drawn. Internal to render/.
// Needs no OpenGL.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/render/camera_model.h"
#include "robocell/render/markers.h"

namespace robocell::internal {

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

}  // namespace robocell::internal
