// Moves a camera of a scene's spec (SceneSpec::cameras) within its parent, without compiling: in the
// model that is simulated and in the spec, so that a scene built from the spec has it there too.
//
//   PlaceCamera(scene, "side", LookAt({1, 0, 1.2}, {0, 0, 0.8}), 45);
#pragma once

#include <string>

#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// `pose_in_parent` is in MuJoCo's camera axes, `fovy` in degrees. The parent is the world or a body:
// CameraSpec::attach_to. Throws NotFoundError for a camera that the spec does not have,
// ArgumentError for one with a model of its own or another parent, and Error on a frozen model.
void PlaceCamera(Scene& scene, const std::string& camera, const Pose& pose_in_parent, double fovy);

}  // namespace robocell::internal
