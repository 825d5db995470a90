// The rig: the frames that several robots share. Every part of robocell that needs them asks here.
//
//   world - root_frame_to_world -> root - shared_base_frame_to_root_frame -> shared base
//         - robot_to_shared_base_frame[r] -> base of robot r
//
// Names read backwards: root_frame_to_world is X_WR, the pose of the root frame in the world.
#pragma once

#include "robocell/math/pose.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

inline Pose RootFrameToWorld(const SceneSpec& spec) { return spec.root_frame_to_world; }

inline Pose SharedBaseFrameToWorld(const SceneSpec& spec) {
  return spec.root_frame_to_world * spec.shared_base_frame_to_root_frame;
}

}  // namespace robocell
