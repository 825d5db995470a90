// The state of a viewer: viewer_impl.cc steps and draws, viewer_input.cc does what the user wants.
// Private to viewer/.
#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/step_gate.h"
#include "robocell/viewer/pacing.h"
#include "robocell/viewer/panels.h"
#include "robocell/viewer/scene_view.h"
#include "robocell/viewer/tcp_handle.h"
#include "robocell/viewer/video_panel.h"
#include "robocell/viewer/viewer.h"
#include "robocell/viewer/window.h"

namespace robocell {

class Viewer::Impl final : public internal::StepGate {
 public:
  Impl(const Scene& scene, const std::vector<Robot>& robots, const ViewerOptions& options);
  ~Impl() override { CloseWindow(); }

  const Scene& scene() const { return view_.scene(); }
  SceneView& view() { return view_; }
  const std::string& title() const { return title_; }
  bool is_running() const { return window_ != nullptr && !scene().closed(); }
  bool detached() const { return detached_; }

  std::string text;  // in the corner

  Answer BeforeStep() override;
  void EndStep() noexcept override;
  void AfterStep() override;
  std::string StopReason() const override;
  void OnClose() override { CloseWindow(); }
  void OnReset() override { pacing_.Restart(); }

  bool Step();
  bool Show();
  // Closes the window, and lets the scene go on.
  void Detach();
  internal::Pacing& pacing() { return pacing_; }
  bool paused() const { return paused_; }
  // Throws Error for a viewer that does not stop its scene.
  void SetPaused(bool paused);
  void DragTcp(const Robot& robot, bool commands);
  std::vector<int> TakeKeys() { return std::exchange(keys_, {}); }
  internal::ViewerVideo& video() { return video_; }
  size_t scenes_held() const {
    return 1 + view_.robots().size() + handles_.size() + (video_.recording() ? 1 : 0);
  }
  void Post(const InputEvent& event) { RequireWindow().Post(event); }
  std::pair<double, double> PlaceOf(std::string_view section, std::string_view item);
  void ShowPanels(std::string_view left, std::string_view right);
  bool panels_shown() const { return panels_.left_shown; }
  void SetPanelsShown(bool shown);
  std::vector<uint8_t> Pixels(int* width, int* height);
  void SaveScreenshot(const std::string& path);

 private:
  static ViewElement::Kind KindOf(int value) { return static_cast<ViewElement::Kind>(value); }
  static double Now();  // seconds of the clock on the wall
  bool on_own_thread() const { return std::this_thread::get_id() == thread_; }
  // What the user may do: stop the scene, set it back, choose its speed.
  bool pauses() const { return options_.stops_scene; }
  bool resets() const { return options_.stops_scene && options_.draws_steps; }
  bool paces() const { return options_.stops_scene || options_.draws_steps; }
  ViewerWindow& RequireWindow() const;
  void CloseWindow();

  void MakeContext();
  void MakeCurrentBuffer();
  void BuildPanels();
  // Writes the present state into what the panels show.
  void ReadValues();
  // Handles the input, draws and shows.
  void Present();
  void Draw();
  void DrawTexts(const mjrRect& rect);
  void WaitForPicture();

  void HandleInput();
  void Handle(const InputEvent& event);
  Eigen::Vector2d Place() const;
  void Mouse(const InputEvent& event);
  void Press(double aspect);
  void Key(const InputEvent& event);
  void NextCamera(int by);
  void Act(const internal::Panels::Change& change);
  // Acts once the window's OpenGL context is no longer current: what runs code of programs, such as
  // reset hooks, or draws elsewhere, such as recorders, may make other contexts current.
  void ActLater(std::function<void()> act) { later_.push_back(std::move(act)); }
  void DoLater();
  void ResetScene();
  void StartVideo();
  void SaveNumberedScreenshot();

  ViewerOptions options_;
  std::string title_;
  std::thread::id thread_;
  SceneView view_;
  internal::PanelValues values_;
  internal::Panels panels_;
  std::unique_ptr<ViewerWindow> window_;
  mjrContext context_ = [] {
    mjrContext context;
    mjr_defaultContext(&context);
    return context;
  }();
  internal::Pacing pacing_;
  internal::ViewerVideo video_;
  std::vector<internal::TcpHandle> handles_;
  std::vector<std::function<void()>> later_;
  std::vector<int> keys_;  // pressed, not taken yet
  std::string message_;
  bool paused_ = false, close_ = false, presenting_ = false, detached_ = false;
  int once_ = 0;  // steps to make while paused
  double step_began_ = 0, step_seconds_ = 0;
};

}  // namespace robocell
