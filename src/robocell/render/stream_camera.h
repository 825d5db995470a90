// The view of a scene that an image stream means.
#pragma once

#include <string>

#include "robocell/render/camera_model.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/camera_spec.h"

namespace robocell::internal {

// Returns the full name of a stream's camera: a robot's own (by its name without the prefix), else
// the scene's. Throws NotFoundError with the nearest names, in the form of the file, and
// ArgumentError if several robots have one of that name.
std::string FindCameraName(const Scene& scene, const CameraConfig& stream);

// Returns the body that a stream follows: of that name, else the root of the object of that name.
// Throws NotFoundError with the nearest names.
int FollowedBody(const Scene& scene, const CameraConfig& stream);

// Returns the view of a stream: its camera, the whole model ("Free", unless a camera has that name)
// or the body or object that it follows. Ids belong to the scene's present model. Throws the errors
// of FindCameraName and FollowedBody.
CameraView ViewOfStream(const Scene& scene, const CameraConfig& stream);

}  // namespace robocell::internal
