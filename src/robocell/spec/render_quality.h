// Qualities of images by name.
//
//   RendererOptions options{.quality = NamedQuality("standard")};
//
//   fast      no effects: what learning from images needs
//   standard  shadows and 4 samples a pixel
//   high      shadows of twice the resolution, 8 samples a pixel and reflections
//
// Any thread. Depth and segmentation are the same in all of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/spec/camera_spec.h"

namespace robocell {

std::vector<std::string> RenderQualities();
// Throws NotFoundError for any other name.
RenderQuality NamedQuality(std::string_view name);

}  // namespace robocell
