#include "robocell/render/image_convert.h"

#include <algorithm>

namespace robocell::internal {

template <class T>
void FlipRows(std::span<T> image, size_t row) {
  const size_t rows = row ? image.size() / row : 0;
  for (size_t top = 0; top < rows / 2; ++top) {
    T* upper = image.data() + top * row;
    std::swap_ranges(upper, upper + row, image.data() + (rows - 1 - top) * row);
  }
}
template void FlipRows(std::span<uint8_t>, size_t);
template void FlipRows(std::span<float>, size_t);
template void FlipRows(std::span<int32_t>, size_t);

void DecodeIds(std::span<const uint8_t> rgb, std::span<const int32_t> table,
               std::span<int32_t> ids) {
  for (size_t i = 0; i < ids.size(); ++i) {
    const uint8_t* p = rgb.data() + 3 * i;
    const uint32_t code = p[0] | p[1] << 8 | p[2] << 16;
    ids[i] = code >= 1 && code <= table.size() ? table[code - 1] : -1;
  }
}

}  // namespace robocell::internal
