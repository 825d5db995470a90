#include "robocell/render/video_recorder.h"

#include <mujoco/mujoco.h>

#include <string>

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

// What MuJoCo's viewer shows first: the whole model.
CameraView InitialView(const mjModel* model) {
  mjvCamera camera;
  mjv_defaultFreeCamera(model, &camera);
  return OrbitCamera{
      .lookat = Eigen::Vector3d(camera.lookat[0], camera.lookat[1], camera.lookat[2]),
      .distance = camera.distance,
      .azimuth = camera.azimuth,
      .elevation = camera.elevation,
      .fovy = model->vis.global.fovy};
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
      view_(InitialView(model)),
      size_{options.width, options.height},
      rgb_(3 * static_cast<size_t>(options.width) * static_cast<size_t>(options.height)) {
  renderer_->SetModel(model);
}

void VideoRecorder::SetModel(const mjModel* model) {
  model_ = model;
  renderer_->SetModel(model);
  if (!camera_name_.empty()) UseCamera(std::string(camera_name_));
}

void VideoRecorder::UseCamera(std::string_view name) {
  view_ = NamedCamera(model_, name, "video '" + path().string() + "'");
  camera_name_ = name;
}

void VideoRecorder::UseCamera(const CameraView& view) {
  view_ = view;
  camera_name_.clear();
}

void VideoRecorder::SetFreeCamera(double distance, double azimuth, double elevation,
                                  const Eigen::Vector3d& lookat) {
  UseCamera(CameraView(OrbitCamera{.lookat = lookat,
                                   .distance = distance,
                                   .azimuth = azimuth,
                                   .elevation = elevation,
                                   .fovy = model_->vis.global.fovy}));
}

void VideoRecorder::RecordFrame(const mjData* data) {
  renderer_->Render(
      data, {.camera = view_, .width = size_.width, .height = size_.height, .markers = markers_},
      {.rgb = rgb_});
  writer_.Write(rgb_);
}

}  // namespace robocell
