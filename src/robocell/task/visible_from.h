// Finds the image stream that an entry of `start.visible_from` means.
#pragma once

#include <string>

#include "robocell/spec/camera_spec.h"

namespace robocell::internal {

// Returns the stream of that name, else the first one of that camera. A camera without a stream
// gets the run's resolution; the result then has no name.
inline CameraConfig StreamToSee(const CameraSystemConfig& cameras, const std::string& name) {
  for (const CameraConfig& stream : cameras.streams) {
    if (stream.name == name) return stream;
  }
  for (const CameraConfig& stream : cameras.streams) {
    if (stream.follow.empty() && stream.camera == name) return stream;
  }
  return {.name = "", .camera = name};
}

}  // namespace robocell::internal
