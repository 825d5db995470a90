// Films a scene into an mp4 and follows it: objects may be added and removed while it films.
//
//   SceneRecorder video(scene, "pick.mp4", {.fps_num = 60});
//   video.SetTrackingCamera("cube", 1.5, 135, -20);
//   for (int i = 0; i < 300; ++i) {
//     scene.StepN(8);
//     video.RecordFrame();
//   }
//   video.Finish();   // the file exists from here on
//
// Frames, cameras and files are those of render/video_recorder.h. The camera in use and a tracked
// body are found again by their names; when they are gone, each frame is a NotFoundError, and
// nothing is filmed, until another camera is chosen or they are there again. It holds the scene
// like any other handle to it. Errors: VideoRecorder's; ClosedError once the scene was closed,
// after which what was recorded can still be finished. Threads: those of the scene, one at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/render/video_recorder.h"
#include "robocell/scene/scene.h"

namespace robocell {

class SceneRecorder {
 public:
  // ArgumentError for an odd size; IoError for a path that cannot be written; Error without encoder
  // or OpenGL, with what to install.
  SceneRecorder(const Scene& scene, std::filesystem::path path,
                const VideoRecorderOptions& options = {});

  // "Current", "Free", "Tracking", then the cameras of robots and objects, then those of
  // SceneSpec::cameras.
  std::vector<std::string> camera_names() const;
  // One of these, or "" for the free camera: NotFoundError with all of them. Before
  // SetTrackingCamera "Tracking" is an ArgumentError.
  void UseCamera(std::string_view name);
  // Ids in the view are of the scene's present model, and followed by their names.
  void UseCamera(const CameraView& view);
  // Degrees and metres in the world, as VideoRecorder's.
  void SetFreeCamera(double distance, double azimuth, double elevation,
                     const Eigen::Vector3d& lookat);
  void SetTrackingCamera(std::string_view body, double distance, double azimuth, double elevation);
  // Drawn into every frame from now on.
  void SetMarkers(std::vector<Marker> markers) { recorder_.SetMarkers(std::move(markers)); }

  // The scene as it is now becomes one frame.
  void RecordFrame();
  // Ends the file. Without it there is none.
  void Finish() { recorder_.Finish(); }

  int64_t frames() const { return recorder_.frames(); }
  const std::filesystem::path& path() const { return recorder_.path(); }
  const Scene& scene() const { return scene_; }

 private:
  VideoRecorder& Follow();
  VideoRecorder& FollowToChange();

  Scene scene_;
  VideoRecorder recorder_;
  uint64_t generation_;  // that the recorder has
};

}  // namespace robocell
