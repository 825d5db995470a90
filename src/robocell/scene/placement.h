// Private to scene: turns an AttachTarget into the parent body and the pose in it. It also defines
// the frames of the rig, which several robots share.
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
  Pose pose;  // pose in the parent body
};

// The meaning of robots' names while a scene is put together.
struct RobotFrames {
  std::string root_body;
  std::optional<std::string> attachment_site;
};
using RobotFrameMap = std::map<std::string, RobotFrames>;

// Returns the engine's kind for a target that is an element; mjOBJ_UNKNOWN for the others.
mjtObj ElementKindOf(AttachKind kind);

// Describes a target for messages: "body 'table'", "the attachment site of robot 'left'", "the
// shared base frame".
std::string DescribeTarget(const AttachTarget& target);

// Finds the target in `spec`. Root and SharedBase are transforms of the world. Unset, with an entry
// in the log, if the element does not exist.
std::optional<Placement> Place(const AttachTarget& target, const Pose& pose, mjSpec* spec,
                               const SceneSpec& scene, const RobotFrameMap& robots,
                               const std::string& place, CompileLog& log);

// Returns the same pose on the world itself, for elements that must hang there (free bodies, mocap
// bodies). A movable parent is a problem, explained by `why`: "a mocap base".
std::optional<Placement> PlaceInWorld(const Placement& placement, const AttachTarget& target,
                                      const std::string& why, const std::string& place,
                                      CompileLog& log);

// The frames of the rig. Every part of robocell that needs them gets them here.
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
