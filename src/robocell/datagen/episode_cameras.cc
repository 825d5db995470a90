#include "robocell/datagen/episode_cameras.h"

#include "robocell/render/stream_camera.h"

namespace robocell {

EpisodeCameras::EpisodeCameras(EpisodeSchema& schema, const Scene& scene,
                               const CameraSystemConfig& config, Renderer* renderer, int fps_num,
                               int fps_den)
    : scene_(scene), renderer_(renderer) {
  if (config.streams.empty()) return;
  renderer_->SetModel(scene.model());
  for (const CameraConfig& stream : config.streams) {
    Stream s;
    s.view = ViewOfStream(scene, stream);
    s.width = config.width(stream);
    s.height = config.height(stream);
    const Eigen::Matrix3d k =
        ComputeCamera(scene.model(), scene.data(), s.view, s.width, s.height).intrinsics();
    s.video = schema.AddCamera(
        {.name = stream.name,
         .width = s.width,
         .height = s.height,
         .fps_num = fps_num,
         .fps_den = fps_den,
         .intrinsics = std::array<double, 9>{k(0, 0), k(0, 1), k(0, 2), k(1, 0), k(1, 1), k(1, 2),
                                             k(2, 0), k(2, 1), k(2, 2)},
         .depth = stream.depth});
    s.extrinsics = schema.AddColumn({.name = "cameras/" + stream.name + "/extrinsics",
                                     .shape = {4, 4},
                                     .units = "m, 1",
                                     .frame = "world -> camera, OpenCV axes"});
    const size_t pixels = static_cast<size_t>(s.width) * static_cast<size_t>(s.height);
    s.rgb.resize(3 * pixels);  // of a size that the schema took
    if (stream.depth) s.depth_mm.resize(pixels);
    streams_.push_back(std::move(s));
  }
}

void EpisodeCameras::PutFrames(EpisodeWriter& writer) {
  for (Stream& s : streams_) {
    const CameraModel camera =
        renderer_->Render(scene_.data(), {.camera = s.view, .width = s.width, .height = s.height},
                          {.rgb = s.rgb, .depth_mm = s.depth_mm});
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> extrinsics = camera.extrinsics();
    writer.Put(s.extrinsics, std::span<const double>(extrinsics.data(), 16));
    writer.WriteFrame(s.video, s.rgb);
    if (!s.depth_mm.empty()) writer.WriteDepth(s.video, s.depth_mm);
  }
}

}  // namespace robocell
