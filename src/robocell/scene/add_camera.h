// Private to scene: a camera on a body.
#pragma once

#include "robocell/scene/placement.h"
#include "robocell/scene/report.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

// `placement` holds the camera's full pose in its body.
void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& place,
               Report& report);

// Sets the vertical field of view, degrees; warns of an angle that was meant in radians.
void SetFovy(mjsCamera* camera, double fovy, const std::string& place, Report& report);

}  // namespace robocell
