#include "robocell/render/video_recorder.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/suggestions.h"
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

std::vector<std::string> RecorderCameras(const mjModel* model) {
  std::vector<std::string> names;
  for (const std::string_view name : {kCurrentCamera, kFreeCamera, kTrackingCamera})
    names.emplace_back(name);
  for (std::string& name : ElementNames(model, mjOBJ_CAMERA)) {
    if (!name.empty() && std::ranges::find(names, name) == names.end())
      names.push_back(std::move(name));
  }
  return names;
}

// The writer comes first: it rejects sizes and paths before the renderer is made.
VideoRecorder::VideoRecorder(const mjModel* model, std::filesystem::path path,
                             const VideoRecorderOptions& options)
    : writer_(std::move(path), ToVideoOptions(options)),
      renderer_(MakeRenderer(options.renderer)),
      model_(model),
      watch_(model),
      free_(InitialView(model)),
      view_(free_),
      size_{options.width, options.height},
      rgb_(3 * static_cast<size_t>(options.width) * static_cast<size_t>(options.height)) {
  renderer_->SetModel(model);
}

void VideoRecorder::SetModel(const mjModel* model) {
  model_ = model;
  watch_ = ModelWatch(model);
  renderer_->SetModel(model);
  LookUpAgain();
}

const mjModel* VideoRecorder::Model() const {
  if (watch_.gone()) {
    throw ArgumentError(Place() +
                        ": the model that it was given was freed; call SetModel after a scene was "
                        "built again, or film with a SceneRecorder");
  }
  return model_;
}

int VideoRecorder::CameraId(std::string_view name) const {
  const int id = FindId(Model(), mjOBJ_CAMERA, name);
  if (id < 0) throw NotFoundError(NoSuchName(Place(), "camera", name, camera_names()));
  return id;
}

TrackingCamera VideoRecorder::TrackingAgain() const {
  if (tracked_.empty()) {
    throw ArgumentError(Place() + ": camera 'Tracking' has nothing to follow yet; " +
                        internal::CppAndPythonName("SetTrackingCamera") + " says which body");
  }
  TrackingCamera view = tracking_;
  view.body = RequireId(Model(), mjOBJ_BODY, tracked_, Place());
  return view;
}

void VideoRecorder::LookUpAgain() {
  if (name_.empty()) return;
  missing_ = true;
  if (auto* tracking = std::get_if<TrackingCamera>(&view_)) {
    tracking->body = RequireId(Model(), mjOBJ_BODY, name_, Place());
  } else {
    view_ = ModelCamera{CameraId(name_)};
  }
  missing_ = false;
}

void VideoRecorder::UseCamera(std::string_view name) {
  const bool ours = FindId(Model(), mjOBJ_CAMERA, name) < 0;  // the model's cameras come first
  if (ours && name == kCurrentCamera) return;
  if (ours && (name.empty() || name == kFreeCamera)) return UseCamera(free_);
  if (ours && name == kTrackingCamera) return UseCamera(TrackingAgain());
  UseCamera(ModelCamera{CameraId(name)});
}

void VideoRecorder::UseCamera(const CameraView& view) {
  const mjModel* model = Model();
  RequireView(view);
  view_ = view;
  missing_ = false;
  name_.clear();
  if (const auto* fixed = std::get_if<ModelCamera>(&view))
    name_ = ElementName(model, mjOBJ_CAMERA, fixed->id);
  if (const auto* tracking = std::get_if<TrackingCamera>(&view))
    name_ = ElementName(model, mjOBJ_BODY, tracking->body);
}

void VideoRecorder::RequireFinite(const std::string& what, double value) const {
  if (!std::isfinite(value))
    throw ArgumentError(fmt::format("{}: {} is {}; it must be finite", Place(), what, value));
}

void VideoRecorder::RequireDirection(double distance, double azimuth, double elevation) const {
  RequireFinite("distance", distance);
  if (distance < 0) {
    throw ArgumentError(fmt::format("{}: distance is {}; it must be 0 or more", Place(), distance));
  }
  RequireFinite("azimuth", azimuth);
  RequireFinite("elevation", elevation);
}

void VideoRecorder::SetFreeCamera(double distance, double azimuth, double elevation,
                                  const Eigen::Vector3d& lookat) {
  RequireDirection(distance, azimuth, elevation);
  for (int i = 0; i < 3; ++i) RequireFinite(fmt::format("lookat[{}]", i), lookat[i]);
  free_ = {.lookat = lookat,
           .distance = distance,
           .azimuth = azimuth,
           .elevation = elevation,
           .fovy = Model()->vis.global.fovy};
  UseCamera(free_);
}

void VideoRecorder::SetTrackingCamera(std::string_view body, double distance, double azimuth,
                                      double elevation) {
  RequireDirection(distance, azimuth, elevation);
  tracking_ = {.body = RequireId(Model(), mjOBJ_BODY, body, Place()),
               .distance = distance,
               .azimuth = azimuth,
               .elevation = elevation,
               .fovy = Model()->vis.global.fovy};
  tracked_ = body;
  UseCamera(tracking_);
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
