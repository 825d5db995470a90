#include "robocell/env/env_cameras.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/render/stream_camera.h"
#include "robocell/scenes/randomized_model.h"

namespace robocell::internal {
namespace {

// Rounding of a time multiplied by a rate: the engine's clock, a sum of steps such as 1/480 s, is
// off by that much after hours.
constexpr double kRounding = 1e-6;

CellImage FrameOf(const CameraConfig& stream, int width, int height) {
  CellImage frame;
  frame.name = stream.name;
  frame.width = width;
  frame.height = height;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (stream.rgb) frame.rgb.resize(3 * pixels);
  if (stream.depth) frame.depth_mm.resize(pixels);
  if (stream.segmentation) frame.bodies.resize(pixels);
  return frame;
}

// Frames are taken at steps of the engine.
void RequireRate(const CameraConfig& stream, double timestep) {
  if (stream.rate * timestep <= 1 + kRounding) return;
  throw ArgumentError(
      fmt::format("stream '{}': its rate, {:g} Hz, is more often than the engine steps, every {:g} "
                  "s; at most {:g} Hz, or leave it out for a frame with every observation",
                  stream.name, stream.rate, timestep, 1 / timestep));
}

}  // namespace

void SharedDrawing::TakeColours(const mjModel* copy) {
  if (!model) return;
  if (!has_looks)
    std::copy_n(copy->geom_rgba, 4 * copy->ngeom, model->geom_rgba);
  else if (CopyLooks(copy, model.get()))
    TexturesChange(model.get());
}

EnvCameras::EnvCameras(Scene scene, const CameraSystemConfig& config,
                       std::shared_ptr<SharedDrawing> shared)
    : scene_(std::move(scene)), shared_(std::move(shared)) {
  if (config.drawn().empty()) return;
  for (const CameraConfig& stream : config.drawn()) {
    RequireRate(stream, scene_.timestep());
    streams_.push_back({.config = stream});
    frames_.push_back(FrameOf(stream, config.width(stream), config.height(stream)));
  }
  if (shared_) {
    renderer_ = shared_->renderer;
  } else {
    renderer_ =
        MakeRenderer({.backend = config.renderer.backend, .quality = config.renderer.quality});
  }
  Bind();
}

void EnvCameras::Bind() {
  if (streams_.empty() || generation_ == scene_.generation()) return;
  const mjModel* m = scene_.model();
  for (Stream& stream : streams_) {
    const CameraConfig& config = stream.config;
    stream.view = ViewOfStream(scene_, config);
    stream.qpos.resize(m->nq);
    stream.mocap_pos.resize(3 * m->nmocap);
    stream.mocap_quat.resize(4 * m->nmocap);
    stream.pending = false;
  }
  if (!shared_) renderer_->SetModel(m);
  scratch_ = MakeData(m);
  generation_ = scene_.generation();
}

void EnvCameras::GoOnFrom(double time) {
  Bind();
  for (Stream& stream : streams_) {
    stream.taken = static_cast<int64_t>(std::floor(time * stream.config.rate + kRounding));
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
  Bind();
  for (Stream& stream : streams_) {
    const double rate = stream.config.rate;
    if (rate > 0 && time * rate + kRounding >= static_cast<double>(stream.taken))
      Keep(stream, time);
  }
}

void EnvCameras::DrawOne(Stream& stream, CellImage& frame) {
  if (shared_) shared_->TakeColours(scene_.model());
  std::copy(stream.qpos.begin(), stream.qpos.end(), scratch_->qpos);
  std::copy(stream.mocap_pos.begin(), stream.mocap_pos.end(), scratch_->mocap_pos);
  std::copy(stream.mocap_quat.begin(), stream.mocap_quat.end(), scratch_->mocap_quat);
  ids_.resize(frame.bodies.size());
  frame.view = stream.view;
  frame.camera = renderer_->Render(
      scratch_.get(), {.camera = stream.view, .width = frame.width, .height = frame.height},
      {.rgb = frame.rgb, .depth_mm = frame.depth_mm, .segmentation = ids_});
  ToSegments(ids_, frame.bodies);
  frame.time = stream.time;
  stream.pending = false;
}

void EnvCameras::Draw(double time) {
  Bind();
  for (size_t i = 0; i < streams_.size(); ++i) {
    if (streams_[i].config.rate == 0) Keep(streams_[i], time);
    if (streams_[i].pending) DrawOne(streams_[i], frames_[i]);
  }
}

}  // namespace robocell::internal
