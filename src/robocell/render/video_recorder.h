// Films a simulation into an mp4: a renderer, a camera and a video file in one object.
//
//   VideoRecorder video(scene.model(), "pick.mp4", {.fps_num = 60});
//   video.SetFreeCamera(2.5, 135, -20, {0, 0, 0.7});
//   for (int i = 0; i < 300; ++i) {
//     scene.StepN(8);
//     video.RecordFrame(scene.data());
//   }
//   video.Finish();   // the file exists from here on
//
// One call is one frame: the caller decides the time between frames, the file plays them at the
// given rate. The camera is free until another one is chosen, and shows the whole model until it is
// set. Lifetime: the model as for Renderer; scene_recorder.h follows a scene whose model is built
// anew. Throws the errors of render/renderer.h and media/video_writer.h, and ArgumentError for
// calls that need a freed model. Threads: one at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/media/video_writer.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/render/renderer.h"

namespace robocell {

// The usual sizes, 16:9.
enum class VideoResolution { kR360p, kR480p, kR720p, kR1080p, kR2K, kR4K };

struct VideoSize {
  int width = 0, height = 0;  // px
};
VideoSize SizeOf(VideoResolution resolution);

// Names that recorders accept beside the cameras of the model: the present camera, the free camera
// and the tracking camera in their last state. A camera of the model with one of these names takes
// precedence.
inline constexpr std::string_view kCurrentCamera = "Current", kFreeCamera = "Free",
                                  kTrackingCamera = "Tracking";
// Returns these three, then the named cameras of a model, in its order.
std::vector<std::string> RecorderCameras(const mjModel* model);

struct VideoRecorderOptions {
  int width = 1280, height = 720;  // px, even
  int fps_num = 60, fps_den = 1;   // frames per second as a ratio
  RendererOptions renderer = {};
};

class VideoRecorder {
 public:
  VideoRecorder(const mjModel* model, std::filesystem::path path,
                const VideoRecorderOptions& options = {});

  // Call it after a rebuild of the scene. A camera of the model and a tracked body are looked
  // up again by their names. Throws NotFoundError if they are missing, here and for each frame
  // until another camera is chosen.
  void SetModel(const mjModel* model);

  std::vector<std::string> camera_names() const { return RecorderCameras(Model()); }
  // Selects one of camera_names(); "" is the free camera too. Throws NotFoundError with the names,
  // and ArgumentError for "Tracking" before SetTrackingCamera has set a body.
  void UseCamera(std::string_view name);
  void UseCamera(const CameraView& view);
  // Selects the free camera: it looks at a point; degrees and metres, like in the interactive
  // viewer.
  void SetFreeCamera(double distance, double azimuth, double elevation,
                     const Eigen::Vector3d& lookat);
  // Follows a body and its subtree, from a constant direction. Throws NotFoundError with the
  // model's bodies.
  void SetTrackingCamera(std::string_view body, double distance, double azimuth, double elevation);

  // Draws them into every frame from now on.
  void SetMarkers(std::vector<Marker> markers) { markers_ = std::move(markers); }

  void RecordFrame(const mjData* data);
  // Ends the file. Without it there is no file.
  void Finish() { writer_.Finish(); }

  int64_t frames() const { return writer_.frames(); }
  const std::filesystem::path& path() const { return writer_.path(); }

 private:
  std::string Place() const;  // place for messages
  // Throws ArgumentError for infinite values and NaN.
  void RequireFinite(const std::string& what, double value) const;
  void RequireDirection(double distance, double azimuth, double elevation) const;
  const mjModel* Model() const;  // throws ArgumentError if it was freed
  int CameraId(std::string_view name) const;
  TrackingCamera TrackingAgain() const;
  void LookUpAgain();

  VideoWriter writer_;
  std::unique_ptr<Renderer> renderer_;
  const mjModel* model_;
  ModelWatch watch_;  // watch of the caller's model
  OrbitCamera free_;
  TrackingCamera tracking_;
  std::string tracked_;  // name of the tracked body; ids change
  CameraView view_;
  std::string name_;      // name of the camera or body in view_
  bool missing_ = false;  // true if the present model has none of that name
  VideoSize size_;
  std::vector<Marker> markers_;
  std::vector<uint8_t> rgb_;
};

}  // namespace robocell
