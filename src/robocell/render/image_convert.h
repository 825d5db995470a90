// Converts OpenGL's output to that of the renderer: rows from the top and body ids. Pure functions
// on buffers of width * height pixels; no allocation. Depth: depth_conversion.h.
#pragma once

#include <cstdint>
#include <span>

namespace robocell::internal {

// Reverses the order of the rows in place. `row` is the number of elements in a row.
template <class T>
void FlipRows(std::span<T> image, size_t row);
extern template void FlipRows(std::span<uint8_t>, size_t);
extern template void FlipRows(std::span<float>, size_t);
extern template void FlipRows(std::span<int32_t>, size_t);

// Decodes colour-coded ids (id + 1 as r + 256 g + 65536 b; black is none) to table[id]; -1 for none
// and for unknown ids.
void DecodeIds(std::span<const uint8_t> rgb, std::span<const int32_t> table,
               std::span<int32_t> ids);

}  // namespace robocell::internal
