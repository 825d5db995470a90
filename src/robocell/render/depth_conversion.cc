#include "robocell/render/depth_conversion.h"

#include <algorithm>
#include <cmath>

namespace robocell::internal {

void RawDepthToMetres(std::span<float> depth, const CameraModel& camera) {
  const double n = camera.near_m, f = camera.far_m;
  if (camera.orthographic) {
    for (float& d : depth) d = d > 0 ? static_cast<float>(f - d * (f - n)) : 0.0f;
  } else {
    for (float& d : depth) d = d > 0 ? static_cast<float>(n * f / (n + d * (f - n))) : 0.0f;
  }
}

void MetresToMillimetres(std::span<const float> metres, std::span<uint16_t> millimetres) {
  for (size_t i = 0; i < metres.size(); ++i) {
    const float mm = std::nearbyint(metres[i] * 1000.0f);
    millimetres[i] = static_cast<uint16_t>(std::clamp(mm, 0.0f, 65535.0f));
  }
}

}  // namespace robocell::internal
