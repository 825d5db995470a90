#include "robocell/features/cell_images.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>

#include "robocell/data/episode_schema.h"
#include "robocell/render/stream_camera.h"

namespace robocell {

void ToSegments(std::span<const int32_t> bodies, std::span<uint16_t> segments) {
  std::ranges::transform(bodies, segments.begin(), [](int32_t body) {
    return body < 0 ? kNoSegment : static_cast<uint16_t>(body);
  });
}

CellImages::CellImages(const Scene& scene, const CameraSystemConfig& config, Renderer* renderer)
    : scene_(scene), renderer_(renderer) {
  for (const CameraConfig& stream : config.drawn()) {
    CellImage image{.name = stream.name,
                    .view = internal::ViewOfStream(scene, stream),
                    .width = config.width(stream),
                    .height = config.height(stream),
                    .time = scene.data()->time,
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

void CellImages::Draw() { Draw(scene_.model(), scene_.data()); }

void CellImages::Draw(const mjModel* model, const mjData* data) {
  if (images_.empty()) return;
  if (!std::exchange(is_ready_, true)) renderer_->SetModel(model);
  for (CellImage& image : images_) {
    const std::span<int32_t> ids = std::span(ids_).first(image.bodies.size());
    image.camera = renderer_->Render(
        data, {.camera = image.view, .width = image.width, .height = image.height},
        {.rgb = image.rgb, .depth_mm = image.depth_mm, .segmentation = ids});
    image.time = data->time;
    ToSegments(ids, image.bodies);
  }
}

}  // namespace robocell
