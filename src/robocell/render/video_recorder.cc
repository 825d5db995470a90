#include "robocell/render/video_recorder.h"

#include <mujoco/mujoco.h>

#include <string>

#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

VideoOptions ToVideoOptions(const VideoRecorderOptions& options) {
  VideoOptions video;
  video.width = options.width;
  video.height = options.height;
  video.fps_num = options.fps_num;
  video.fps_den = options.fps_den;
  return video;
}

}  // namespace

VideoSize SizeOf(VideoResolution resolution) {
  switch (resolution) {
    case VideoResolution::kR360p:
      return {640, 360};
    case VideoResolution::kR480p:
      return {854, 480};
    case VideoResolution::kR720p:
      return {1280, 720};
    case VideoResolution::kR1080p:
      return {1920, 1080};
    case VideoResolution::kR2K:
      return {2560, 1440};
    case VideoResolution::kR4K:
      return {3840, 2160};
  }
  return {};
}

// The writer first: it refuses sizes and places before the renderer is made.
VideoRecorder::VideoRecorder(const mjModel* model, std::filesystem::path path,
                             const VideoRecorderOptions& options)
    : writer_(std::move(path), ToVideoOptions(options)),
      renderer_(MakeRenderer(options.renderer)),
      model_(model),
      free_(InitialView(model)),
      view_(free_),
      size_{options.width, options.height},
      rgb_(3 * static_cast<size_t>(options.width) * static_cast<size_t>(options.height)) {
  renderer_->SetModel(model);
}

void VideoRecorder::SetModel(const mjModel* model) {
  model_ = model;
  renderer_->SetModel(model);
  LookUpAgain();
}

void VideoRecorder::LookUpAgain() {
  if (name_.empty()) return;
  missing_ = true;
  if (auto* tracking = std::get_if<TrackingCamera>(&view_)) {
    tracking->body = RequireId(model_, mjOBJ_BODY, name_, Place());
  } else {
    view_ = NamedCamera(model_, name_, Place());
  }
  missing_ = false;
}

void VideoRecorder::UseCamera(std::string_view name) {
  UseCamera(name.empty() ? CameraView(free_) : NamedCamera(model_, name, Place()));
}

void VideoRecorder::UseCamera(const CameraView& view) {
  view_ = view;
  missing_ = false;
  name_.clear();
  if (const auto* fixed = std::get_if<ModelCamera>(&view))
    name_ = ElementName(model_, mjOBJ_CAMERA, fixed->id);
  if (const auto* tracking = std::get_if<TrackingCamera>(&view))
    name_ = ElementName(model_, mjOBJ_BODY, tracking->body);
}

void VideoRecorder::SetFreeCamera(double distance, double azimuth, double elevation,
                                  const Eigen::Vector3d& lookat) {
  free_ = {.lookat = lookat,
           .distance = distance,
           .azimuth = azimuth,
           .elevation = elevation,
           .fovy = model_->vis.global.fovy};
  UseCamera(free_);
}

void VideoRecorder::SetTrackingCamera(std::string_view body, double distance, double azimuth,
                                      double elevation) {
  UseCamera(TrackingCamera{.body = RequireId(model_, mjOBJ_BODY, body, Place()),
                           .distance = distance,
                           .azimuth = azimuth,
                           .elevation = elevation,
                           .fovy = model_->vis.global.fovy});
}

std::string VideoRecorder::Place() const { return "video '" + path().string() + "'"; }

void VideoRecorder::RecordFrame(const mjData* data) {
  if (missing_) LookUpAgain();  // throws
  renderer_->Render(
      data, {.camera = view_, .width = size_.width, .height = size_.height, .markers = markers_},
      {.rgb = rgb_});
  writer_.Write(rgb_);
}

}  // namespace robocell
