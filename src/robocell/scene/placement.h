// Private to scene: turns an AttachTarget into the body that something is put on and the pose in
// it. The frames of the rig, which several robots share, are here too.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <optional>
#include <string>

#include "robocell/math/pose.h"
#include "robocell/scene/compile_log.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

struct Placement {
  mjsBody* parent = nullptr;
  Pose pose;  // in the parent body
};

// What names of robots stand for while a scene is put together.
struct RobotFrames {
  std::string root_body;
  std::optional<std::string> attachment_site;
};
using RobotFrameMap = std::map<std::string, RobotFrames>;

// The engine's kind of element for a target that is one; mjOBJ_UNKNOWN for the others.
mjtObj ElementKindOf(AttachKind kind);

// "body 'table'", "the attachment site of robot 'left'", "the shared base frame": for messages.
std::string DescribeTarget(const AttachTarget& target);

// Finds the target in `spec`. Root and SharedBase are transforms of the world. Null and an entry in
// the log when the element does not exist.
std::optional<Placement> Place(const AttachTarget& target, const Pose& pose, mjSpec* spec,
                               const SceneSpec& scene, const RobotFrameMap& robots,
                               const std::string& place, CompileLog& log);

// The same pose on the world itself, for what must hang there (free bodies, mocap bodies). A parent
// that can move is a problem, said as `why`: "a mocap base".
std::optional<Placement> PlaceInWorld(const Placement& placement, const AttachTarget& target,
                                      const std::string& why, const std::string& place,
                                      CompileLog& log);

// The frames of the rig. Every part of robocell that needs them asks here.
//
//   world - root_frame_to_world -> root - shared_base_frame_to_root_frame -> shared base
//         - robot_to_shared_base_frame[r] -> base of robot r
//
// Names read backwards: root_frame_to_world is X_WR, the pose of the root frame in the world.
inline Pose RootFrameToWorld(const SceneSpec& spec) { return spec.root_frame_to_world; }

inline Pose SharedBaseFrameToWorld(const SceneSpec& spec) {
  return spec.root_frame_to_world * spec.shared_base_frame_to_root_frame;
}

}  // namespace robocell::internal
