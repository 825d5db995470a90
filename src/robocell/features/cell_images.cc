#include "robocell/features/cell_images.h"

#include <algorithm>
#include <span>
#include <utility>

#include "robocell/render/stream_camera.h"

namespace robocell {

CellImages::CellImages(const Scene& scene, const CameraSystemConfig& config, Renderer* renderer)
    : scene_(scene), renderer_(renderer) {
  if (config.streams.empty()) return;
  renderer_->SetModel(scene.model());
  for (const CameraConfig& stream : config.streams) {
    CellImage image{.name = stream.name,
                    .view = internal::ViewOfStream(scene, stream),
                    .width = config.width(stream),
                    .height = config.height(stream),
                    .camera = {},
                    .rgb = {},
                    .depth_mm = {},
                    .bodies = {}};
    image.camera =
        ComputeCamera(scene.model(), scene.data(), image.view, image.width, image.height);
    const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
    image.rgb.resize(3 * pixels);
    if (stream.depth) image.depth_mm.resize(pixels);
    if (stream.segmentation) image.bodies.resize(pixels);
    ids_.resize(std::max(ids_.size(), image.bodies.size()));
    images_.push_back(std::move(image));
  }
}

void CellImages::Draw() {
  for (CellImage& image : images_) {
    const std::span<int32_t> ids = std::span(ids_).first(image.bodies.size());
    image.camera = renderer_->Render(
        scene_.data(), {.camera = image.view, .width = image.width, .height = image.height},
        {.rgb = image.rgb, .depth_mm = image.depth_mm, .segmentation = ids});
    std::ranges::transform(ids, image.bodies.begin(), [](int32_t body) {
      return body < 0 ? kNoBody : static_cast<uint16_t>(body);
    });
  }
}

}  // namespace robocell
