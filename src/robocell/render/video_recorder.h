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
// set. Lifetime: the model as for Renderer. Errors: those of render/renderer.h and
// media/video_writer.h. Threads: one at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/media/video_writer.h"
#include "robocell/render/renderer.h"

namespace robocell {

// The usual sizes, 16:9.
enum class VideoResolution { kR360p, kR480p, kR720p, kR1080p, kR2K, kR4K };

struct VideoSize {
  int width = 0, height = 0;  // px
};
VideoSize SizeOf(VideoResolution resolution);

struct VideoRecorderOptions {
  int width = 1280, height = 720;  // px, even
  int fps_num = 60, fps_den = 1;   // frames per second as a ratio
  RendererOptions renderer = {};
};

class VideoRecorder {
 public:
  VideoRecorder(const mjModel* model, std::filesystem::path path,
                const VideoRecorderOptions& options = {});

  // After the scene was compiled anew. A camera of the model and a tracked body are looked up again
  // by their names: NotFoundError when they are gone, here and for each frame until another camera
  // is chosen.
  void SetModel(const mjModel* model);

  // A camera of the model (NotFoundError with its cameras); "" is the free camera.
  void UseCamera(std::string_view name);
  void UseCamera(const CameraView& view);
  // The free camera, from now on: looks at a point; degrees and metres, as in the interactive
  // viewer.
  void SetFreeCamera(double distance, double azimuth, double elevation,
                     const Eigen::Vector3d& lookat);
  // Follows a body and what hangs from it, from the same direction. NotFoundError with the model's
  // bodies.
  void SetTrackingCamera(std::string_view body, double distance, double azimuth, double elevation);

  // Drawn into every frame from now on.
  void SetMarkers(std::vector<Marker> markers) { markers_ = std::move(markers); }

  void RecordFrame(const mjData* data);
  // Ends the file. Without it there is none.
  void Finish() { writer_.Finish(); }

  int64_t frames() const { return writer_.frames(); }
  const std::filesystem::path& path() const { return writer_.path(); }

 private:
  std::string Place() const;  // for messages
  void LookUpAgain();

  VideoWriter writer_;
  std::unique_ptr<Renderer> renderer_;
  const mjModel* model_;
  OrbitCamera free_;
  CameraView view_;
  std::string name_;      // of the model's camera or the body in view_
  bool missing_ = false;  // the present model has none of that name
  VideoSize size_;
  std::vector<Marker> markers_;
  std::vector<uint8_t> rgb_;
};

}  // namespace robocell
