#include "robocell/rollout/episode_cameras.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/render/stream_camera.h"

namespace robocell {

std::vector<SegmentLabel> SegmentLabelsOf(const Scene& scene) {
  const mjModel* model = scene.model();
  std::vector<SegmentLabel> labels(static_cast<size_t>(model->nbody));
  const auto own = [&](const std::string& body, const std::string& owner) {
    const int id = mj_name2id(model, mjOBJ_BODY, body.c_str());
    const bool is_free = id >= 0 && labels[id].owner.empty();
    if (is_free) labels[id].owner = owner;
    return is_free;
  };
  // A robot in the model of another one has its base, and begins at its own root.
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    const std::string owner = "robots/" + robot.name;
    if (!own(robot.base_body, owner)) own(robot.root_body, owner);
  }
  for (const ObjectRecord& object : scene.compiled()->objects())
    own(object.root_body, "objects/" + object.name);
  for (int b = 0; b < model->nbody; ++b) {
    const char* name = mj_id2name(model, mjOBJ_BODY, b);
    labels[b].name = name ? name : "";
    // Parents come first. What is mounted on a robot is its own, or an object's.
    if (b > 0 && labels[b].owner.empty()) labels[b].owner = labels[model->body_parentid[b]].owner;
  }
  return labels;
}

EpisodeCameras::EpisodeCameras(EpisodeSchema& schema, const Scene& scene,
                               const CameraSystemConfig& config, Renderer* renderer,
                               const Ratio& rate)
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
         .fps_num = static_cast<int>(rate.num),
         .fps_den = static_cast<int>(rate.den),
         .intrinsics = std::array<double, 9>{k(0, 0), k(0, 1), k(0, 2), k(1, 0), k(1, 1), k(1, 2),
                                             k(2, 0), k(2, 1), k(2, 2)},
         .depth = stream.depth,
         .segmentation = stream.segmentation});
    s.extrinsics = schema.AddColumn({.name = "cameras/" + stream.name + "/extrinsics",
                                     .shape = {4, 4},
                                     .units = "m, 1",
                                     .frame = "world -> camera, OpenCV axes"});
    const size_t pixels = static_cast<size_t>(s.width) * static_cast<size_t>(s.height);
    s.rgb.resize(3 * pixels);  // of a size that the schema took
    if (stream.depth) s.depth_mm.resize(pixels);
    if (stream.segmentation) {
      s.bodies.resize(pixels);
      s.labels.resize(pixels);
      schema.SetSegmentLabels(SegmentLabelsOf(scene));
    }
    streams_.push_back(std::move(s));
  }
}

void EpisodeCameras::PutFrames(EpisodeWriter& writer) {
  for (Stream& s : streams_) {
    const CameraModel camera =
        renderer_->Render(scene_.data(), {.camera = s.view, .width = s.width, .height = s.height},
                          {.rgb = s.rgb, .depth_mm = s.depth_mm, .segmentation = s.bodies});
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> extrinsics = camera.extrinsics();
    writer.Put(s.extrinsics, std::span<const double>(extrinsics.data(), 16));
    writer.WriteFrame(s.video, s.rgb);
    if (!s.depth_mm.empty()) writer.WriteDepth(s.video, s.depth_mm);
    if (s.labels.empty()) continue;
    std::transform(s.bodies.begin(), s.bodies.end(), s.labels.begin(), [](int32_t body) {
      return body < 0 ? kNoSegment : static_cast<uint16_t>(body);
    });
    writer.WriteSegmentation(s.video, s.labels);
  }
}

}  // namespace robocell
