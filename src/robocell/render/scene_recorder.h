// Films a scene into an mp4 and follows it: objects may be added and removed meanwhile.
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
// body are found again by their names; while they are missing, each frame throws NotFoundError and
// films nothing, until another camera is chosen or they exist again. It holds the scene like any
// other handle to it. Throws VideoRecorder's errors; ClosedError once the scene was closed, after
// which the recording can still be finished. Threads: those of the scene, one at a time.
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
  // Throws ArgumentError for an odd size, IoError for a path that cannot be written, and Error
  // without encoder or OpenGL, with what to install.
  SceneRecorder(const Scene& scene, std::filesystem::path path,
                const VideoRecorderOptions& options = {});

  // Returns "Current", "Free", "Tracking", then the cameras of robots and objects, then those of
  // SceneSpec::cameras.
  std::vector<std::string> camera_names() const;
  // Selects one of these, or "" for the free camera. Throws NotFoundError with all of them, and
  // ArgumentError for "Tracking" before SetTrackingCamera.
  void UseCamera(std::string_view name);
  // Ids in the view belong to the scene's present model, and are followed by their names.
  void UseCamera(const CameraView& view);
  // Degrees and metres in the world, as for VideoRecorder.
  void SetFreeCamera(double distance, double azimuth, double elevation,
                     const Eigen::Vector3d& lookat);
  void SetTrackingCamera(std::string_view body, double distance, double azimuth, double elevation);
  // Draws them into every frame from now on.
  void SetMarkers(std::vector<Marker> markers) { recorder_.SetMarkers(std::move(markers)); }

  // Films the present scene as one frame.
  void RecordFrame();
  // Ends the file. Without it there is no file.
  void Finish() { recorder_.Finish(); }

  int64_t frames() const { return recorder_.frames(); }
  const std::filesystem::path& path() const { return recorder_.path(); }
  const Scene& scene() const { return scene_; }

 private:
  VideoRecorder& Follow();
  VideoRecorder& FollowToChange();

  Scene scene_;
  VideoRecorder recorder_;
  uint64_t generation_;  // generation of the recorder's model
};

}  // namespace robocell
