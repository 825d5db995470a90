// Cameras outside of a model, and Python's ways to name a camera.
#pragma once

#include <string_view>

#include "bindings.h"
#include "robocell/render/camera_model.h"

namespace robocell::python {

// Returns the view of a camera's name ("" is the view of the whole model), an OrbitCamera,
// FreeCamera or TrackingCamera. `place` is for messages: NotFoundError for unknown names, TypeError
// for anything else.
CameraView ViewOf(const mjModel* model, nb::handle camera, std::string_view place);

// Converts three numbers. Throws ArgumentError "lookat must be 3 numbers, got 2".
Eigen::Vector3d ToPoint(nb::handle lookat);

void BindCameras(nb::module_& m);
void BindVideo(nb::module_& m);

}  // namespace robocell::python
