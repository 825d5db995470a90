// From what OpenGL reads back to what callers get: rows from the top, metric depth, body ids. Pure
// functions on buffers of width * height pixels; no allocation.
#pragma once

#include <cstdint>
#include <span>

#include "robocell/render/camera_model.h"

namespace robocell {

// Reverses the order of the rows in place. `row` is the number of elements in a row.
template <class T>
void FlipRows(std::span<T> image, size_t row);
extern template void FlipRows(std::span<uint8_t>, size_t);
extern template void FlipRows(std::span<float>, size_t);
extern template void FlipRows(std::span<int32_t>, size_t);

// Raw reversed depth (1 at the near plane, 0 at the far plane) to metres in front of the camera's
// plane; 0 where nothing was hit. In place.
void RawDepthToMetres(std::span<float> depth, const CameraModel& camera);

// Metres to whole millimetres, rounded; 0 stays 0 (nothing hit), more than 65.535 m becomes 65535.
void MetresToMillimetres(std::span<const float> metres, std::span<uint16_t> millimetres);

// Colour-coded ids (id + 1 as r + 256 g + 65536 b; black is none) to table[id]; -1 for none and for
// unknown ids.
void DecodeIds(std::span<const uint8_t> rgb, std::span<const int32_t> table,
               std::span<int32_t> ids);

}  // namespace robocell
