// Which view of a scene an image stream means.
#pragma once

#include <string>

#include "robocell/render/camera_model.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell::internal {

// The full name of a stream's camera: a robot's own (by its name without the prefix), else the
// scene's. NotFoundError with the nearest names, as they are written here; ArgumentError when
// several robots have one of that name.
std::string FindCameraName(const Scene& scene, const CameraConfig& stream);

// The view of a stream: its camera, the whole model ("Free", unless a camera is called so) or the
// body that it follows. Ids are of the scene's present model. Errors: those of FindCameraName;
// NotFoundError for a body that the scene does not have.
CameraView ViewOfStream(const Scene& scene, const CameraConfig& stream);

}  // namespace robocell::internal
