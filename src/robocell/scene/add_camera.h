// Private to scene: adds a camera to a body.
#pragma once

#include "robocell/scene/compile_log.h"
#include "robocell/scene/placement.h"
#include "robocell/spec/camera_spec.h"
#include "robocell/spec/sim_options.h"

namespace robocell::internal {

// `placement` is the full pose, in its body, of the camera or of its model's root. Relative model
// paths start at `directory`.
void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& directory,
               const SimOptions& options, const std::string& place, CompileLog& log);

// Sets the vertical field of view, degrees; warns of an angle that is probably in radians.
void SetFovy(mjsCamera* camera, double fovy, const std::string& place, CompileLog& log);

}  // namespace robocell::internal
