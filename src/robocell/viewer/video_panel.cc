#include "robocell/viewer/video_panel.h"

#include <fmt/format.h>

#include <utility>

#include "robocell/base/error.h"

namespace robocell::internal {

void ViewerVideo::Start(const SceneView& view, const std::string& path, int fps, VideoSize size,
                        std::string_view camera) {
  if (recorder_) {
    throw Error(fmt::format("viewer: '{}' is being recorded; stop it before another video",
                            recorder_->path().string()));
  }
  if (fps < 1)
    throw ArgumentError(
        fmt::format("viewer: a video needs at least 1 frame a second, got {}", fps));
  auto recorder = std::make_unique<SceneRecorder>(
      view.scene(), path,
      VideoRecorderOptions{.width = size.width, .height = size.height, .fps_num = fps});
  follows_ = camera == kCurrentCamera || camera == kTrackingCamera || camera.empty();
  if (follows_) {
    recorder->UseCamera(view.view());
  } else {
    recorder->UseCamera(camera);
  }
  recorder_ = std::move(recorder);
  period_ = 1. / fps;
  next_ = last_ = view.scene().time();
  state_ = fmt::format("recording {}", path);
}

void ViewerVideo::Record(const SceneView& view) {
  if (!recorder_) return;
  const double now = view.scene().time();
  const double passed = now - std::exchange(last_, now);
  if (passed < 0 || passed > 1.5 * view.scene().timestep()) next_ = now;
  try {
    for (; now >= next_ - 1e-9; next_ += period_) {
      if (follows_) recorder_->UseCamera(view.view());
      recorder_->RecordFrame();
      state_ =
          fmt::format("recording {}, {} frames", recorder_->path().string(), recorder_->frames());
    }
  } catch (const Error& error) {
    recorder_.reset();
    state_ = fmt::format("failed: {}", error.what());
  }
}

std::string ViewerVideo::Stop() {
  if (!recorder_) return "";
  const auto recorder = std::move(recorder_);
  try {
    recorder->Finish();
  } catch (const Error& error) {
    Fail(fmt::format("failed: {}", error.what()));
    throw;
  }
  state_ = "saved " + recorder->path().string();
  return recorder->path().string();
}

}  // namespace robocell::internal
