#include "robocell/rollout/episode_cameras.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>

namespace robocell::internal {

std::vector<SegmentLabel> SegmentLabelsOf(const Scene& scene) {
  const mjModel* model = scene.model();
  std::vector<SegmentLabel> labels(static_cast<size_t>(model->nbody));
  const auto own = [&](const std::string& body, const std::string& owner) {
    const int id = mj_name2id(model, mjOBJ_BODY, body.c_str());
    const bool is_free = id >= 0 && labels[id].owner.empty();
    if (is_free) labels[id].owner = owner;
    return is_free;
  };
  // A robot in the model of another one has that robot's base, and begins at its own root.
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    const std::string owner = "robots/" + robot.name;
    if (!own(robot.base_body, owner)) own(robot.root_body, owner);
  }
  for (const ObjectRecord& object : scene.compiled()->objects())
    own(object.root_body, "objects/" + object.name);
  for (int b = 0; b < model->nbody; ++b) {
    const char* name = mj_id2name(model, mjOBJ_BODY, b);
    labels[b].name = name ? name : "";
    // Parents come first. A body mounted on a robot belongs to that robot, or to an object.
    if (b > 0 && labels[b].owner.empty()) labels[b].owner = labels[model->body_parentid[b]].owner;
  }
  return labels;
}

EpisodeCameras::EpisodeCameras(EpisodeSchema& schema, const Scene& scene,
                               std::span<const CellImage> images, const Ratio& rate,
                               FrameTimes times) {
  bool has_segments = false;
  for (const CellImage& image : images) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> k = image.camera.intrinsics();
    std::array<double, 9> intrinsics = {};
    std::copy_n(k.data(), intrinsics.size(), intrinsics.begin());
    Stream stream;
    stream.video = schema.AddCamera({.name = image.name,
                                     .width = image.width,
                                     .height = image.height,
                                     .fps_num = static_cast<int>(rate.num),
                                     .fps_den = static_cast<int>(rate.den),
                                     .intrinsics = intrinsics,
                                     .depth = !image.depth_mm.empty(),
                                     .segmentation = !image.bodies.empty()});
    const std::string path = "cameras/" + image.name + "/";
    stream.extrinsics = schema.AddColumn({.name = path + "extrinsics",
                                          .shape = {4, 4},
                                          .units = "m, 1",
                                          .frame = "world -> camera, OpenCV axes"});
    if (times == FrameTimes::kOwn) {
      stream.time = schema.AddColumn({.name = path + "time",
                                      .units = "s",
                                      .description = "When the frame was taken, since the reset: "
                                                     "streams with a rate of their own show one "
                                                     "until the next."});
    }
    has_segments = has_segments || !image.bodies.empty();
    streams_.push_back(stream);
  }
  if (has_segments) schema.SetSegmentLabels(SegmentLabelsOf(scene));
}

void EpisodeCameras::Put(EpisodeWriter& writer, std::span<const CellImage> images,
                         std::span<const double> times) const {
  for (size_t i = 0; i < streams_.size(); ++i) {
    const Stream& stream = streams_[i];
    const CellImage& image = images[i];
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> extrinsics = image.camera.extrinsics();
    writer.Put(stream.extrinsics, std::span<const double>(extrinsics.data(), 16));
    if (!times.empty()) writer.Put(stream.time, times[i]);
    writer.WriteFrame(stream.video, image.rgb);
    if (!image.depth_mm.empty()) writer.WriteDepth(stream.video, image.depth_mm);
    if (!image.bodies.empty()) writer.WriteSegmentation(stream.video, image.bodies);
  }
}

}  // namespace robocell::internal
