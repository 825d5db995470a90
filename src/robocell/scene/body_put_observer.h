// Private to scene and robot: a SceneObserver that is also notified when bodies are moved.
#pragma once

#include "robocell/math/pose.h"

namespace robocell::internal {

class BodyPutObserver {
 public:
  virtual ~BodyPutObserver() = default;
  // Called before Scene::SetBodyPose moves a free or mocap body: the state is still the previous
  // one.
  virtual void OnBodyPut(int body, const Pose& pose_in_world) = 0;
};

}  // namespace robocell::internal
