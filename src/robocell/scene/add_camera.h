// Private to scene: a camera on a body.
#pragma once

#include "robocell/scene/placement.h"
#include "robocell/spec/camera_spec.h"

namespace robocell {

// `placement` holds the camera's full pose in its body.
void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& place);

}  // namespace robocell
