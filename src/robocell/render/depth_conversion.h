// Converts the renderer's depth to metres and millimetres. Pure functions on buffers of width *
// height pixels; no allocation.
#pragma once

#include <cstdint>
#include <span>

#include "robocell/render/camera_model.h"

namespace robocell::internal {

// Converts raw reversed depth (1 at the near plane, 0 at the far plane) to metres in front of the
// camera's plane; 0 for pixels without a surface. In place.
void RawDepthToMetres(std::span<float> depth, const CameraModel& camera);

// Converts metres to whole millimetres, rounded; 0 (no surface) stays 0, more than 65.535 m becomes
// 65535.
void MetresToMillimetres(std::span<const float> metres, std::span<uint16_t> millimetres);

}  // namespace robocell::internal
