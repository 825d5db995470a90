// Private to scene: the steps of making a robot's model. Names are those of the robot's own model,
// without its prefix; `spec` is that model.
#pragma once

#include <mujoco/mujoco.h>

#include "robocell/scene/part.h"
#include "robocell/spec/robot_spec.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

// edits.cc
void ApplyEdits(const RobotConfig& config, Part& robot, CompileLog& log);

// attachments.cc: mounts tools one after the other; their keyframes join the robot's. `locations`
// and `directory` are those of the spec that lists them.
void AddAttachments(const List<AttachmentSpec>& attachments, const Locations& locations,
                    const std::string& directory, Part& robot, const SceneSpec& scene,
                    CompileLog& log);

// add_camera.cc
void AddRobotCameras(const RobotConfig& config, const std::string& directory, Part& robot,
                     const SceneSpec& scene, CompileLog& log);

// robot_overrides.cc: gravcomp, stiffness, damping, force_limit.
void ApplyOverrides(const RobotConfig& config, Part& robot, CompileLog& log);

// first_joints.cc: keeps `top`, and bodies fixed to it, from touching the bodies that joints attach
// to them, as the engine itself does on a movable base. Does nothing if the scene enables contacts
// of neighbours (it disables filterparent).
void ExcludeFirstJoints(mjsBody* top, const SimOptions& options, mjSpec* spec);

// Adds the site for attachment_site * tcp_offset if both are configured.
std::optional<std::string> AddTcpSite(const RobotConfig& config, Part& robot, CompileLog& log);

}  // namespace robocell::internal
