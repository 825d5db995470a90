#include "robocell/env/env_cameras.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/render/stream_camera.h"

namespace robocell {
namespace {

constexpr double kRounding = 1e-9;  // of times a rate

EnvFrame FrameOf(const CameraConfig& stream, int width, int height) {
  EnvFrame frame{.stream = stream.name, .width = width, .height = height};
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (stream.rgb) frame.rgb.resize(3 * pixels);
  if (stream.depth) frame.depth_mm.resize(pixels);
  if (stream.segmentation) frame.segmentation.resize(pixels);
  return frame;
}

}  // namespace

EnvCameras::EnvCameras(Scene scene, const CameraSystemConfig& config) : scene_(std::move(scene)) {
  if (config.streams.empty()) return;
  const mjModel* m = scene_.model();
  for (const CameraConfig& stream : config.streams) {
    Stream& added = streams_.emplace_back();
    added.view = NamedCamera(m, FindCameraName(scene_, stream), "stream '" + stream.name + "'");
    added.rate = stream.rate;
    added.qpos.resize(m->nq);
    added.mocap_pos.resize(3 * m->nmocap);
    added.mocap_quat.resize(4 * m->nmocap);
    frames_.push_back(FrameOf(stream, config.width(stream), config.height(stream)));
  }
  renderer_ = MakeRenderer({.quality = config.quality});
  renderer_->SetModel(m);
  scratch_ = MakeData(m);
}

void EnvCameras::GoOnFrom(double time) {
  for (Stream& stream : streams_) {
    stream.taken = static_cast<int64_t>(std::floor(time * stream.rate + kRounding));
    Keep(stream, time);
  }
}

void EnvCameras::Keep(Stream& stream, double time) {
  const mjData* d = scene_.data();
  std::copy_n(d->qpos, stream.qpos.size(), stream.qpos.begin());
  std::copy_n(d->mocap_pos, stream.mocap_pos.size(), stream.mocap_pos.begin());
  std::copy_n(d->mocap_quat, stream.mocap_quat.size(), stream.mocap_quat.begin());
  stream.time = time;
  stream.pending = true;
  ++stream.taken;
}

void EnvCameras::Tick(double time) {
  for (Stream& stream : streams_) {
    if (stream.rate > 0 && time * stream.rate + kRounding >= static_cast<double>(stream.taken))
      Keep(stream, time);
  }
}

void EnvCameras::DrawOne(Stream& stream, EnvFrame& frame) {
  std::copy(stream.qpos.begin(), stream.qpos.end(), scratch_->qpos);
  std::copy(stream.mocap_pos.begin(), stream.mocap_pos.end(), scratch_->mocap_pos);
  std::copy(stream.mocap_quat.begin(), stream.mocap_quat.end(), scratch_->mocap_quat);
  frame.camera = renderer_->Render(
      scratch_.get(), {.camera = stream.view, .width = frame.width, .height = frame.height},
      {.rgb = frame.rgb, .depth_mm = frame.depth_mm, .segmentation = frame.segmentation});
  frame.time = stream.time;
  stream.pending = false;
}

void EnvCameras::Draw(double time) {
  for (size_t i = 0; i < streams_.size(); ++i) {
    if (streams_[i].rate == 0) Keep(streams_[i], time);
    if (streams_[i].pending) DrawOne(streams_[i], frames_[i]);
  }
}

}  // namespace robocell
