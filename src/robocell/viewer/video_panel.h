// ViewerVideo: the recorder of a viewer: one picture for each 1 / fps seconds of simulation, by a
// camera of the scene or by that of the viewer. Internal to viewer/.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "robocell/render/scene_recorder.h"
#include "robocell/viewer/scene_view.h"

namespace robocell::internal {

class ViewerVideo {
 public:
  // Throws Error if one is being recorded, and the errors of SceneRecorder.
  void Start(const SceneView& view, const std::string& path, int fps, VideoSize size,
             std::string_view camera);
  bool recording() const { return recorder_ != nullptr; }
  // Records the pictures that are due at the present time of the scene; call it after each step. A
  // jump of time, by a reset or a state that was set, is one picture. An error ends the video and
  // becomes the state.
  void Record(const SceneView& view);
  // Completes the file and returns its path; "" if nothing is being recorded.
  std::string Stop();
  // Returns "idle", "recording a.mp4, 120 frames", "saved a.mp4", or the error.
  const std::string& state() const { return state_; }
  void Fail(const std::string& message) { state_ = message; }

 private:
  std::unique_ptr<SceneRecorder> recorder_;
  bool follows_ = false;  // the viewer's camera
  double next_ = 0;       // time of the next picture
  double last_ = 0;       // time of the last call of Record
  double period_ = 0;
  std::string state_ = "idle";
};

}  // namespace robocell::internal
