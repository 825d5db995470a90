#include "robocell/render/renderer.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr int kLargest = 16384;  // pixels a side

void CheckSize(const char* image, size_t have, const RenderRequest& request, size_t per_pixel) {
  const size_t want =
      static_cast<size_t>(request.width) * static_cast<size_t>(request.height) * per_pixel;
  if (have == 0 || have == want) return;
  throw ArgumentError(fmt::format("{} buffer has {} elements, an image of {} x {} pixels needs {}",
                                  image, have, request.width, request.height, want));
}

}  // namespace

void CheckImageSize(int width, int height) {
  if (width >= 1 && height >= 1 && width <= kLargest && height <= kLargest) return;
  throw ArgumentError(fmt::format("an image of {} x {} pixels; each side must be between 1 and {}",
                                  width, height, kLargest));
}

void CheckOutputs(const RenderRequest& request, const RenderOutputs& outputs) {
  CheckImageSize(request.width, request.height);
  CheckSize("rgb", outputs.rgb.size(), request, 3);
  CheckSize("depth", outputs.depth.size(), request, 1);
  CheckSize("depth_mm", outputs.depth_mm.size(), request, 1);
  CheckSize("segmentation", outputs.segmentation.size(), request, 1);
}

}  // namespace robocell
