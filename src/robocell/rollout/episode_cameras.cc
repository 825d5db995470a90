#include "robocell/rollout/episode_cameras.h"

#include <mujoco/mujoco.h>

#include <array>

namespace robocell::internal {

static_assert(kNoBody == kNoSegment);

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
                               const CameraSystemConfig& config, Renderer* renderer,
                               const Ratio& rate)
    : images_(scene, config, renderer) {
  for (const CellImage& image : images_.images()) {
    const Eigen::Matrix3d k = image.camera.intrinsics();
    Stream stream;
    stream.video = schema.AddCamera(
        {.name = image.name,
         .width = image.width,
         .height = image.height,
         .fps_num = static_cast<int>(rate.num),
         .fps_den = static_cast<int>(rate.den),
         .intrinsics = std::array<double, 9>{k(0, 0), k(0, 1), k(0, 2), k(1, 0), k(1, 1), k(1, 2),
                                             k(2, 0), k(2, 1), k(2, 2)},
         .depth = !image.depth_mm.empty(),
         .segmentation = !image.bodies.empty()});
    stream.extrinsics = schema.AddColumn({.name = "cameras/" + image.name + "/extrinsics",
                                          .shape = {4, 4},
                                          .units = "m, 1",
                                          .frame = "world -> camera, OpenCV axes"});
    if (!image.bodies.empty()) schema.SetSegmentLabels(SegmentLabelsOf(scene));
    streams_.push_back(stream);
  }
}

void EpisodeCameras::PutFrames(EpisodeWriter& writer) {
  images_.Draw();
  for (size_t i = 0; i < streams_.size(); ++i) {
    const CellImage& image = images_.images()[i];
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> extrinsics = image.camera.extrinsics();
    writer.Put(streams_[i].extrinsics, std::span<const double>(extrinsics.data(), 16));
    writer.WriteFrame(streams_[i].video, image.rgb);
    if (!image.depth_mm.empty()) writer.WriteDepth(streams_[i].video, image.depth_mm);
    if (!image.bodies.empty()) writer.WriteSegmentation(streams_[i].video, image.bodies);
  }
}

}  // namespace robocell::internal
