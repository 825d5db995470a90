// Depth as the renderer has it, in metres and in millimetres. Pure functions on buffers of
// width * height pixels; no allocation.
#pragma once

#include <cstdint>
#include <span>

#include "robocell/render/camera_model.h"

namespace robocell::internal {

// Raw reversed depth (1 at the near plane, 0 at the far plane) to metres in front of the camera's
// plane; 0 where nothing was hit. In place.
void RawDepthToMetres(std::span<float> depth, const CameraModel& camera);

// Metres to whole millimetres, rounded; 0 stays 0 (nothing hit), more than 65.535 m becomes 65535.
void MetresToMillimetres(std::span<const float> metres, std::span<uint16_t> millimetres);

}  // namespace robocell::internal
