#include "robocell/render/renderer.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr int kLargest = 16384;  // pixels a side

void RequireSize(const char* image, size_t have, const RenderRequest& request, size_t per_pixel) {
  const size_t want =
      static_cast<size_t>(request.width) * static_cast<size_t>(request.height) * per_pixel;
  if (have == 0 || have == want) return;
  throw ArgumentError(fmt::format("{} buffer has {} elements, an image of {} x {} pixels needs {}",
                                  image, have, request.width, request.height, want));
}

}  // namespace

void RequireImageSize(int width, int height) {
  if (width >= 1 && height >= 1 && width <= kLargest && height <= kLargest) return;
  throw ArgumentError(fmt::format("an image of {} x {} pixels; each side must be between 1 and {}",
                                  width, height, kLargest));
}

void RequireOutputs(const RenderRequest& request, const RenderOutputs& outputs) {
  RequireImageSize(request.width, request.height);
  RequireSize("rgb", outputs.rgb.size(), request, 3);
  RequireSize("depth", outputs.depth.size(), request, 1);
  RequireSize("depth_mm", outputs.depth_mm.size(), request, 1);
  RequireSize("segmentation", outputs.segmentation.size(), request, 1);
}

}  // namespace robocell
