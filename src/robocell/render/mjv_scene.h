// Owner of MuJoCo's abstract scene (mjvScene): a list of elements to draw. Internal to render/
// and viewer/. Needs no OpenGL.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/render/camera_model.h"
#include "robocell/render/markers.h"

namespace robocell::internal {

class MjvScene {
 public:
  // Reserves space for everything a model can show, and for more elements. Throws EngineError.
  explicit MjvScene(const mjModel* model, int more = 0);
  ~MjvScene() { mjv_freeScene(&scene_); }
  MjvScene(const MjvScene&) = delete;
  MjvScene& operator=(const MjvScene&) = delete;

  mjvScene* get() { return &scene_; }
  // Makes the scene use this camera from the next update on.
  void SetCamera(const CameraModel& camera);
  void Add(const Marker& marker);
  // Planes receive shadows but cast none, because nothing behind them would show any. On themselves
  // they would show speckles, because so large a surface is drawn with less precision than the
  // shadow map allows for. Call it after every update.
  void LetPlanesCastNoShadow();

 private:
  mjvScene scene_;
};

}  // namespace robocell::internal
