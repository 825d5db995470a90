// Private to scene and robot: a SceneObserver that also hears of bodies that are put elsewhere.
#pragma once

#include "robocell/math/pose.h"

namespace robocell::internal {

class BodyPutObserver {
 public:
  virtual ~BodyPutObserver() = default;
  // Before Scene::SetBodyPose moves a free or mocap body: the state is still the one before.
  virtual void OnBodyPut(int body, const Pose& pose_in_world) = 0;
};

}  // namespace robocell::internal
