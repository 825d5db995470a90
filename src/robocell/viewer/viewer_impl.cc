// Stepping, pacing and drawing.
#include "robocell/viewer/viewer_impl.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/media/png.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/step.h"
#include "robocell/render/markers.h"
#include "robocell/viewer/edit_values.h"

namespace robocell {
namespace {

using internal::NameRows;

constexpr double kPicturesPerSecond = 60;

// A slider has no place for more digits.
double Rounded(double value) { return std::round(1e4 * value) / 1e4; }

void Sleep(double seconds) {
  if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// True until its end, also by an exception.
class Flagged {
 public:
  explicit Flagged(bool& flag) : flag_(flag) { flag_ = true; }
  ~Flagged() { flag_ = false; }
  Flagged(const Flagged&) = delete;
  Flagged& operator=(const Flagged&) = delete;

 private:
  bool& flag_;
};

// The lines of the help, keys and what they do.
struct HelpTexts {
  std::string keys, texts;

  void Add(const char* key, const char* text) {
    keys += keys.empty() ? "" : "\n";
    keys += key;
    texts += texts.empty() ? "" : "\n";
    texts += text;
  }
};

HelpTexts Help(const internal::PanelValues& offered) {
  HelpTexts help;
  if (offered.pauses) help.Add("Space", "pause, go on");
  if (offered.resets) {
    help.Add("Right", "one step while paused");
    help.Add("Backspace", "reset the scene");
  }
  if (offered.paces) help.Add(",  .", "half, double the speed");
  help.Add("[  ]", "previous, next camera");
  help.Add("Esc", "free camera");
  help.Add("D", "deselect");
  help.Add("Ctrl + S", "screenshot");
  help.Add("Ctrl + Q", "close the window");
  help.Add("Tab", "panels on, off");
  help.Add("F1", "help");
  help.Add("F2", "timing");
  help.Add("Left drag", "turn the camera");
  help.Add("Right drag", "move the camera");
  help.Add("Scroll", "zoom");
  help.Add("Double click", "select a body");
  help.Add("Ctrl + right drag", "pull the body");
  help.Add("Ctrl + left drag", "turn the body");
  help.Add("Drag the TCP's handle", "move the robot");
  help.Add("with Shift", "turn the TCP");
  return help;
}

std::string SpeedText(double measured, double requested) {
  return requested > 0 ? fmt::format("{:.2f}x of {:g}x", measured, requested)
                       : fmt::format("{:.2f}x, unlimited", measured);
}

}  // namespace

Viewer::Impl::Impl(const Scene& scene, const std::vector<Robot>& robots,
                   const ViewerOptions& options)
    : options_(options),
      title_(options.title.empty() ? scene.name() : options.title),
      thread_(std::this_thread::get_id()),
      view_(scene, robots),
      panels_(values_) {
  window_ = options.on_screen ? OpenDesktopWindow(title_, options.width, options.height)
                              : OpenOffscreenWindow(options.width, options.height);
  values_.pauses = pauses();
  values_.resets = resets();
  values_.paces = paces();
  values_.frames.all = [this] { return view_.elements(KindOf(values_.frame_kind)); };
  values_.traces.all = [this] { return view_.elements(KindOf(values_.trace_kind)); };
  values_.joints.all = [this] { return internal::ScalarJoints(this->scene().model()); };
  values_.controls.all = [this] { return internal::NamedActuators(this->scene().model()); };
  values_.cameras.all = [this] { return view_.camera_names(); };
  values_.video_cameras.all = [this] {
    std::vector<std::string> names = view_.camera_names();
    names.insert(names.begin(), std::string(kCurrentCamera));
    return names;
  };
  values_.video_cameras.chosen = kCurrentCamera;
  values_.frame_length = view_.frame_length();
  const ViewerWindow::Current current(*window_);
  MakeContext();
}

double Viewer::Impl::Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// --- StepGate ------------------------------------------------------------------------------------

internal::StepGate::Answer Viewer::Impl::BeforeStep() {
  if (detached_) return kGo;
  if (!window_) return options_.stops_scene ? kStop : kGo;
  if (!on_own_thread()) return kGo;
  if (paused_ && once_ == 0) {
    view_.ApplyForce(true);
    WaitForPicture();
    if (detached_) return kGo;
    if (!window_) return kStop;
    if (paused_ && once_ == 0) return kHold;
  }
  if (once_ > 0) --once_;
  view_.ApplyForce(false);
  step_began_ = Now();
  return kGo;
}

void Viewer::Impl::EndStep() noexcept {
  if (detached_ || !window_ || !on_own_thread()) return;
  view_.EndForce();
}

void Viewer::Impl::AfterStep() {
  if (detached_ || !window_ || !on_own_thread()) return;
  step_seconds_ += 0.05 * (Now() - step_began_ - step_seconds_);
  view_.ExtendTraces();
  video_.Record(view_);
  if (!options_.draws_steps) return;
  double wait = pacing_.Wait(scene().time(), Now());
  const double end = Now() + wait;
  if (pacing_.ShouldDraw(Now())) Present();
  while (window_ && !paused_ && (wait = end - Now()) > 0) {  // a slow simulation still draws
    Sleep(std::min(wait, std::max(0., pacing_.next_picture() - Now())));
    if (pacing_.ShouldDraw(Now()) && end > Now()) Present();
  }
}

std::string Viewer::Impl::StopReason() const {
  return fmt::format(
      "stopped: the user closed the window '{}'; close() of the viewer lets the scene go on",
      title_);
}

// --- calls ---------------------------------------------------------------------------------------

bool Viewer::Impl::Step() {
  if (!window_) return false;
  Scene scene = view_.scene();
  const StepResult result = scene.StepN(1);
  if (result.status == StepResult::kDiverged) {
    message_ = result.message;
    paused_ = pauses();
  }
  return is_running();
}

bool Viewer::Impl::Show() {
  if (!window_) return false;
  Present();
  return is_running();
}

void Viewer::Impl::Detach() {
  if (!scene().closed()) view_.EndForce();
  detached_ = true;
  CloseWindow();
}

void Viewer::Impl::SetPaused(bool paused) {
  if (paused && !pauses()) {
    throw Error(
        fmt::format("viewer '{}' does not stop its scene, whose steps belong to episodes or which "
                    "it was opened for with stops_scene = false: it cannot pause. Stop the loop "
                    "of the program instead",
                    title_));
  }
  paused_ = paused;
  if (paused) return;
  message_.clear();
  pacing_.Restart();
}

void Viewer::Impl::DragTcp(const Robot& robot, bool commands) {
  RequireRobotOf(scene(), robot);
  handles_.emplace_back(robot, commands);
}

std::pair<double, double> Viewer::Impl::PlaceOf(std::string_view section, std::string_view item) {
  const ViewerWindow::Current current(RequireWindow());
  MakeCurrentBuffer();
  return panels_.PlaceOf(section, item, &context_);
}

void Viewer::Impl::ShowPanels(std::string_view left, std::string_view right) {
  const ViewerWindow::Current current(RequireWindow());
  MakeCurrentBuffer();
  panels_.ShowOnly(left, right, &context_);
}

void Viewer::Impl::SetPanelsShown(bool shown) {
  const ViewerWindow::Current current(RequireWindow());
  panels_.left_shown = panels_.right_shown = shown;
  panels_.Layout(window_->width(), window_->height(), &context_);
}

std::vector<uint8_t> Viewer::Impl::Pixels(int* width, int* height) {
  ViewerWindow& window = RequireWindow();
  const ViewerWindow::Current current(window);
  Draw();
  *width = window.width();
  *height = window.height();
  const size_t row = 3 * static_cast<size_t>(*width);
  std::vector<uint8_t> raw(row * static_cast<size_t>(*height)), pixels(raw.size());
  mjr_readPixels(raw.data(), nullptr, {0, 0, *width, *height}, &context_);
  for (size_t y = 0; y < static_cast<size_t>(*height); ++y) {  // rows come from the bottom
    std::copy_n(raw.begin() + static_cast<ptrdiff_t>(row * (static_cast<size_t>(*height) - 1 - y)),
                row, pixels.begin() + static_cast<ptrdiff_t>(row * y));
  }
  return pixels;
}

void Viewer::Impl::SaveScreenshot(const std::string& path) {
  int width = 0, height = 0;
  const std::vector<uint8_t> pixels = Pixels(&width, &height);
  WritePng(path, RgbImage{width, height, pixels});
}

ViewerWindow& Viewer::Impl::RequireWindow() const {
  if (!window_) throw ClosedError(fmt::format("viewer '{}' is closed", title_));
  return *window_;
}

void Viewer::Impl::CloseWindow() {
  if (!window_) return;
  try {
    video_.Stop();
  } catch (const Error& error) {
    LogWarn(fmt::format("viewer: the video was not saved: {}", error.what()));
  }
  {
    const ViewerWindow::Current current(*window_);
    mjr_freeContext(&context_);
  }
  window_.reset();
}

// --- drawing -------------------------------------------------------------------------------------

void Viewer::Impl::MakeContext() {
  const mjModel* model = scene().model();
  mjr_freeContext(&context_);
  mjModel view = *model;  // shallow: sizes of the window's buffers are the viewer's
  view.vis.global.offwidth = window_->offscreen() ? window_->width() : 64;
  view.vis.global.offheight = window_->offscreen() ? window_->height() : 64;
  internal::Guarded("viewer: uploading the model to OpenGL",
                    [&] { mjr_makeContext(&view, &context_, window_->font_percent()); });
  MakeCurrentBuffer();
  BuildPanels();
}

void Viewer::Impl::MakeCurrentBuffer() {
  mjr_setBuffer(window_->offscreen() ? mjFB_OFFSCREEN : mjFB_WINDOW, &context_);
}

void Viewer::Impl::BuildPanels() {
  for (NameRows* rows : {&values_.frames, &values_.traces, &values_.joints, &values_.controls})
    rows->Choose();
  values_.cameras.chosen = view_.camera();
  values_.cameras.Choose();
  values_.video_cameras.Choose();
  ReadValues();
  panels_.Build(
      &context_, window_->width(), window_->height(),
      [this](const std::string& name) { return internal::JointRange(scene().model(), name); },
      [this](const std::string& name) { return internal::ControlRange(scene().model(), name); });
}

void Viewer::Impl::ReadValues() {
  values_.run = paused_ ? 0 : 1;
  values_.factor = pacing_.factor();
  const ViewFlags& flags = view_.flags;  // programs change them too
  values_.contacts = flags.contacts;
  values_.collision = flags.collision_geoms;
  values_.joint_axes = flags.joints;
  values_.transparent = flags.transparent;
  values_.shadows = flags.shadows;
  values_.frame_labels = flags.labels;
  values_.frame_length = view_.frame_length();
  values_.trace_length = view_.traces.length();
  values_.measured = fmt::format("{:.2f}x", pacing_.measured());
  values_.selected = view_.selected().empty() ? "-" : view_.selected();
  values_.video_state = video_.state();
  for (size_t i = 0; i < values_.frames.shown.size(); ++i)
    values_.frames.on[i] = view_.ShowsFrame({KindOf(values_.frame_kind), values_.frames.shown[i]});
  for (size_t i = 0; i < values_.traces.shown.size(); ++i)
    values_.traces.on[i] = view_.Traces({KindOf(values_.trace_kind), values_.traces.shown[i]});
  for (size_t i = 0; i < values_.joints.shown.size(); ++i)
    values_.joints.value[i] = Rounded(internal::JointValue(scene(), values_.joints.shown[i]));
  for (size_t i = 0; i < values_.controls.shown.size(); ++i)
    values_.controls.value[i] = Rounded(internal::ControlValue(scene(), values_.controls.shown[i]));
}

void Viewer::Impl::Present() {
  if (presenting_) return;  // a reset by the user, which steps
  const Flagged presenting(presenting_);
  const double begin = Now();
  {
    const ViewerWindow::Current current(*window_);
    HandleInput();
  }
  DoLater();
  if (close_) CloseWindow();
  if (window_ && !scene().closed()) {
    const ViewerWindow::Current current(*window_);
    Draw();
    window_->Show();
  }
  pacing_.Drew(begin, Now(), kPicturesPerSecond);
  panels_.picture_seconds = Now() - begin;
}

void Viewer::Impl::Draw() {
  MakeCurrentBuffer();
  if (view_.Follow()) MakeContext();
  if (values_.cameras.chosen != view_.camera()) BuildPanels();
  for (internal::TcpHandle& handle : handles_) handle.Follow();
  std::vector<Marker> markers;
  for (const internal::TcpHandle& handle : handles_) handle.AddMarkers(markers);
  view_.SetMarkers(std::move(markers));
  ReadValues();
  const mjrRect rect = panels_.scene_rect();
  const double aspect =
      rect.height > 0 && rect.width > 0 ? static_cast<double>(rect.width) / rect.height : 1;
  view_.Update(aspect);
  internal::Guarded("viewer: drawing", [&] {
    mjr_rectangle({0, 0, panels_.state().rect[0].width, panels_.state().rect[0].height}, 0.2f, 0.3f,
                  0.4f, 1);
    mjr_render(rect, view_.list(), &context_);
  });
  DrawTexts(rect);
  panels_.Draw(&context_);
}

void Viewer::Impl::DrawTexts(const mjrRect& rect) {
  const auto overlay = [&](int place, const std::string& left, const std::string& right) {
    mjr_overlay(mjFONT_NORMAL, place, rect, left.c_str(), right.c_str(), &context_);
  };
  if (values_.help) {
    const HelpTexts help = Help(values_);
    overlay(mjGRID_TOPLEFT, help.keys, help.texts);
  }
  if (values_.timing) {
    const mjData* d = scene().data();
    overlay(mjGRID_BOTTOMLEFT, "Time\nSpeed\nStep\nContacts\nCamera",
            fmt::format("{:.3f} s\n{}\n{:.3f} ms\n{}\n{}", d->time,
                        SpeedText(pacing_.measured(), pacing_.factor()), 1e3 * step_seconds_,
                        d->ncon, view_.camera()));
  }
  if (paused_) overlay(mjGRID_TOP, "paused: Space goes on", "");
  const std::string state = video_.recording() ? video_.state() : "";
  const std::string corner = text + (text.empty() || state.empty() ? "" : "\n") + state;
  if (!corner.empty()) overlay(mjGRID_TOPRIGHT, corner, "");
  if (!message_.empty()) overlay(mjGRID_BOTTOMRIGHT, message_, "");
}

void Viewer::Impl::WaitForPicture() {
  Sleep(pacing_.next_picture() - Now());
  Present();
  pacing_.Restart();
}

}  // namespace robocell
