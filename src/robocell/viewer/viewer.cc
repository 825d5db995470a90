#include "robocell/viewer/viewer.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/media/png.h"
#include "robocell/mujoco/guard.h"
#include "robocell/scene/step_gate.h"
#include "robocell/viewer/edit_values.h"
#include "robocell/viewer/pacing.h"
#include "robocell/viewer/panels.h"
#include "robocell/viewer/tcp_handle.h"
#include "robocell/viewer/video_panel.h"

namespace robocell {
namespace {

using internal::NameRows;
using internal::Pacing;
using internal::PanelItem;
using internal::Panels;

constexpr double kPicturesPerSecond = 60;
constexpr const char* kGateKey = "viewer";

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A slider has no place for more digits.
double Rounded(double value) { return std::round(1e4 * value) / 1e4; }

void Sleep(double seconds) {
  if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

constexpr const char* kHelpKeys =
    "Space\nRight\nBackspace\n,  .\n[  ]\nEsc\nD\nCtrl + S\nCtrl + Q\nTab\nF1\nF2\n"
    "Left drag\nRight drag\nScroll\nDouble click\nCtrl + right drag\nCtrl + left drag\n"
    "Drag the TCP's handle\nwith Shift";
constexpr const char* kHelpTexts =
    "pause, go on\none step while paused\nreset the scene\nhalf, double the speed\n"
    "previous, next camera\nfree camera\ndeselect\nscreenshot\nclose the window\npanels on, "
    "off\nhelp\ntiming\n"
    "turn the camera\nmove the camera\nzoom\nselect a body\npull the body\nturn the body\n"
    "move the robot\nturn the TCP";

}  // namespace

class Viewer::Impl final : public internal::StepGate {
 public:
  Impl(const Scene& scene, const std::vector<Robot>& robots, const ViewerOptions& options)
      : options_(options),
        title_(options.title.empty() ? scene.name() : options.title),
        thread_(std::this_thread::get_id()),
        view_(scene, robots),
        panels_(values_) {
    window_ = options.on_screen ? OpenDesktopWindow(title_, options.width, options.height)
                                : OpenOffscreenWindow(options.width, options.height);
    values_.frames.all = [this] { return view_.elements(KindOf(values_.frame_kind)); };
    values_.traces.all = [this] { return view_.elements(KindOf(values_.trace_kind)); };
    values_.joints.all = [this] { return internal::ScalarJoints(this->scene().model()); };
    values_.controls.all = [this] { return internal::NamedActuators(this->scene().model()); };
    values_.frame_length = view_.frame_length();
    const ViewerWindow::Current current(*window_);
    MakeContext();
  }

  ~Impl() override { CloseWindow(); }

  const Scene& scene() const { return view_.scene(); }
  SceneView& view() { return view_; }
  const std::string& title() const { return title_; }
  bool is_running() const { return window_ != nullptr && !scene().closed(); }
  bool detached() const { return detached_; }

  std::string text;       // in the corner
  std::vector<int> keys;  // pressed, not taken yet

  // --- StepGate ---
  Answer BeforeStep() override {
    if (detached_) return kGo;
    if (!window_) return options_.stops_scene ? kStop : kGo;
    if (!on_own_thread()) return kGo;
    const bool held = paused_ && options_.stops_scene;
    if (held && once_ == 0) {
      view_.ApplyForce(true);
      WaitForPicture();
      if (!window_) return kStop;
      if (paused_ && once_ == 0) return kHold;
    }
    if (once_ > 0) --once_;
    view_.ApplyForce(false);
    step_began_ = Now();
    return kGo;
  }

  void AfterStep() override {
    if (detached_ || !window_ || !on_own_thread()) return;
    step_seconds_ += 0.05 * (Now() - step_began_ - step_seconds_);
    view_.EndForce();
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

  std::string StopReason() const override {
    return fmt::format(
        "stopped: the user closed the window '{}'; close() of the viewer lets the "
        "scene go on",
        title_);
  }

  void OnClose() override { CloseWindow(); }
  void OnReset() override { pacing_.Restart(); }

  // --- calls ---
  bool Step() {
    if (!window_) return false;
    Scene scene = view_.scene();
    const StepResult result = scene.StepN(1);
    if (result.status == StepResult::kDiverged) {
      view_.EndForce();
      message_ = result.message;
      paused_ = true;
    }
    return is_running();
  }

  bool Show() {
    if (!window_) return false;
    Present();
    return is_running();
  }

  void Detach() {
    if (!scene().closed()) view_.EndForce();
    detached_ = true;
    CloseWindow();
  }

  Pacing& pacing() { return pacing_; }
  bool paused() const { return paused_; }
  void set_paused(bool paused) {
    paused_ = paused;
    if (!paused) {
      message_.clear();
      pacing_.Restart();
    }
  }

  void DragTcp(const Robot& robot, bool commands) { handles_.emplace_back(robot, commands); }

  internal::ViewerVideo& video() { return video_; }
  size_t scenes_held() const {
    return 1 + view_.robots().size() + handles_.size() + (video_.recording() ? 1 : 0);
  }

  void Post(const InputEvent& event) { RequireWindow().Post(event); }

  std::pair<double, double> PlaceOf(std::string_view section, std::string_view item) {
    const ViewerWindow::Current current(RequireWindow());
    MakeCurrentBuffer();
    return panels_.PlaceOf(section, item, &context_);
  }

  void ShowPanels(std::string_view left, std::string_view right) {
    const ViewerWindow::Current current(RequireWindow());
    MakeCurrentBuffer();
    panels_.ShowOnly(left, right, &context_);
  }

  bool panels_shown() const { return panels_.left_shown; }
  void SetPanelsShown(bool shown) {
    const ViewerWindow::Current current(RequireWindow());
    panels_.left_shown = panels_.right_shown = shown;
    panels_.Layout(window_->width(), window_->height(), &context_);
  }

  std::vector<uint8_t> Pixels(int* width, int* height) {
    ViewerWindow& window = RequireWindow();
    const ViewerWindow::Current current(window);
    Draw();
    *width = window.width();
    *height = window.height();
    const size_t row = 3 * static_cast<size_t>(*width);
    std::vector<uint8_t> raw(row * static_cast<size_t>(*height)), pixels(raw.size());
    mjr_readPixels(raw.data(), nullptr, {0, 0, *width, *height}, &context_);
    for (size_t y = 0; y < static_cast<size_t>(*height); ++y) {  // rows come from the bottom
      std::copy_n(
          raw.begin() + static_cast<ptrdiff_t>(row * (static_cast<size_t>(*height) - 1 - y)), row,
          pixels.begin() + static_cast<ptrdiff_t>(row * y));
    }
    return pixels;
  }

  void SaveScreenshot(const std::string& path) {
    int width = 0, height = 0;
    const std::vector<uint8_t> pixels = Pixels(&width, &height);
    WritePng(path, RgbImage{width, height, pixels});
  }

 private:
  static ViewElement::Kind KindOf(int value) { return static_cast<ViewElement::Kind>(value); }
  bool on_own_thread() const { return std::this_thread::get_id() == thread_; }

  ViewerWindow& RequireWindow() const {
    if (!window_) throw ClosedError(fmt::format("viewer '{}' is closed", title_));
    return *window_;
  }

  void CloseWindow() {
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

  // --- drawing ---
  void MakeContext() {
    const mjModel* model = scene().model();
    mjr_freeContext(&context_);
    mjModel view = *model;  // shallow: sizes of the window's buffers are the viewer's
    view.vis.global.offwidth = window_->offscreen() ? window_->width() : 64;
    view.vis.global.offheight = window_->offscreen() ? window_->height() : 64;
    internal::Guarded("viewer: uploading the model to OpenGL",
                      [&] { mjr_makeContext(&view, &context_, window_->font_percent()); });
    MakeCurrentBuffer();
    values_.cameras = view_.camera_names();
    BuildPanels();
  }

  void MakeCurrentBuffer() {
    mjr_setBuffer(window_->offscreen() ? mjFB_OFFSCREEN : mjFB_WINDOW, &context_);
  }

  void BuildPanels() {
    for (NameRows* rows : {&values_.frames, &values_.traces, &values_.joints, &values_.controls})
      rows->Choose();
    ReadValues();
    panels_.Build(
        &context_, window_->width(), window_->height(),
        [this](const std::string& name) { return internal::JointRange(scene().model(), name); },
        [this](const std::string& name) { return internal::ControlRange(scene().model(), name); });
  }

  // Writes the present state into what the panels show.
  void ReadValues() {
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
    for (size_t i = 0; i < values_.frames.shown.size(); ++i) {
      values_.frames.on[i] =
          view_.ShowsFrame({KindOf(values_.frame_kind), values_.frames.shown[i]});
    }
    for (size_t i = 0; i < values_.traces.shown.size(); ++i)
      values_.traces.on[i] = view_.Traces({KindOf(values_.trace_kind), values_.traces.shown[i]});
    for (size_t i = 0; i < values_.joints.shown.size(); ++i)
      values_.joints.value[i] = Rounded(internal::JointValue(scene(), values_.joints.shown[i]));
    for (size_t i = 0; i < values_.controls.shown.size(); ++i)
      values_.controls.value[i] =
          Rounded(internal::ControlValue(scene(), values_.controls.shown[i]));
    const auto& cameras = values_.cameras;
    const auto camera = std::find(cameras.begin(), cameras.end(), view_.camera());
    values_.camera = static_cast<int>(camera - cameras.begin());
  }

  // Handles the input, draws and shows.
  void Present() {
    if (presenting_) return;  // a reset by the user, which steps
    presenting_ = true;
    const double begin = Now();
    {
      const ViewerWindow::Current current(*window_);
      MakeCurrentBuffer();
      if (view_.Follow()) MakeContext();
      for (const InputEvent& event : window_->Poll()) {
        try {
          Handle(event);
        } catch (const Error& error) {
          message_ = error.what();
        }
        if (close_) break;
      }
      if (!close_) {
        Draw();
        window_->Show();
      }
    }
    presenting_ = false;
    if (close_) CloseWindow();
    if (screenshot_ && window_) {
      screenshot_ = false;
      SaveNumbered();
    }
    pacing_.Drew(begin, Now(), kPicturesPerSecond);
    panels_.picture_seconds = Now() - begin;
  }

  void Draw() {
    MakeCurrentBuffer();
    if (view_.Follow()) MakeContext();
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
      mjr_rectangle({0, 0, panels_.state().rect[0].width, panels_.state().rect[0].height}, 0.2f,
                    0.3f, 0.4f, 1);
      mjr_render(rect, view_.list(), &context_);
    });
    DrawTexts(rect);
    panels_.Draw(&context_);
  }

  void DrawTexts(const mjrRect& rect) {
    const auto overlay = [&](int place, const std::string& left, const std::string& right) {
      mjr_overlay(mjFONT_NORMAL, place, rect, left.c_str(), right.c_str(), &context_);
    };
    if (values_.help) overlay(mjGRID_TOPLEFT, kHelpKeys, kHelpTexts);
    if (values_.timing) {
      const mjData* d = scene().data();
      overlay(
          mjGRID_BOTTOMLEFT, "Time\nSpeed\nStep\nContacts\nCamera",
          fmt::format("{:.3f} s\n{:.2f}x of {:g}x\n{:.3f} ms\n{}\n{}", d->time, pacing_.measured(),
                      pacing_.factor(), 1e3 * step_seconds_, d->ncon, view_.camera()));
    }
    if (paused_) overlay(mjGRID_TOP, "paused: Space goes on", "");
    const std::string state = video_.recording() ? video_.state() : "";
    const std::string corner = text + (text.empty() || state.empty() ? "" : "\n") + state;
    if (!corner.empty()) overlay(mjGRID_TOPRIGHT, corner, "");
    if (!message_.empty()) overlay(mjGRID_BOTTOMRIGHT, message_, "");
  }

  void WaitForPicture() {
    Sleep(pacing_.next_picture() - Now());
    Present();
    pacing_.Restart();
  }

  void SaveNumbered() {
    std::string path;
    for (int i = 1;; ++i) {
      path = fmt::format("screenshot_{:03}.png", i);
      if (!std::filesystem::exists(path)) break;
    }
    try {
      SaveScreenshot(path);
      message_ = "saved " + path;
    } catch (const Error& error) {
      message_ = error.what();
    }
  }

  // --- input ---
  void Handle(const InputEvent& event) {
    if (event.type == InputEvent::kClose) {
      close_ = true;
      return;
    }
    if (event.type == InputEvent::kResize) {
      panels_.Layout(window_->width(), window_->height(), &context_);
      return;
    }
    const Panels::Change change = panels_.Handle(event, Now(), &context_);
    if (change.item != PanelItem::kNone) Act(change);
    if (change.used) return;
    if (event.type == InputEvent::kKey) {
      Key(event);
    } else {
      Mouse(event);
    }
  }

  Eigen::Vector2d Place() const {
    const mjuiState& s = panels_.state();
    const mjrRect& rect = panels_.scene_rect();
    return {(s.x - rect.left) / std::max(1, rect.width),
            (s.y - rect.bottom) / std::max(1, rect.height)};
  }

  void Mouse(const InputEvent& event) {
    const mjuiState& s = panels_.state();
    const mjrRect& rect = panels_.scene_rect();
    const double height = std::max(1, rect.height);
    const double aspect = rect.width / height;
    if (event.type == InputEvent::kScroll) {
      if (s.mouserect == 3) view_.MoveCamera(mjMOUSE_ZOOM, 0, -0.05 * s.sy);
      return;
    }
    if (event.type == InputEvent::kPress && s.mouserect == 3) {
      if (s.doubleclick) {
        view_.Select(Place().x(), Place().y(), aspect);
        return;
      }
      if (event.button == mjBUTTON_LEFT && !event.control) {
        for (internal::TcpHandle& handle : handles_) {
          if (handle.Grab(view_, Place(), aspect)) return;
        }
      }
      const bool chosen = values_.drag != 0 && !view_.selected().empty();
      if (!view_.selected().empty() && (event.control || chosen)) {
        const bool turns = event.control ? event.button == mjBUTTON_LEFT : values_.drag == 2;
        view_.Hold(turns);
      }
      return;
    }
    if (event.type == InputEvent::kRelease) {
      view_.Release();
      for (internal::TcpHandle& handle : handles_) handle.Let();
      return;
    }
    if (event.type != InputEvent::kMove || !(s.left || s.right || s.middle)) return;
    for (internal::TcpHandle& handle : handles_) {
      if (!handle.grabbed()) continue;
      handle.Drag(view_, Place(), event.shift, s.dx / height, s.dy / height);
      message_ = handle.problem();
      return;
    }
    const int move = s.shift ? mjMOUSE_MOVE_H : mjMOUSE_MOVE_V;
    const int turn = s.shift ? mjMOUSE_ROTATE_H : mjMOUSE_ROTATE_V;
    const double dx = s.dx / height, dy = -s.dy / height;
    if (view_.holds()) {
      const bool turns = values_.drag == 2 || (s.left && values_.drag == 0);
      view_.MoveHeld(turns ? turn : move, dx, dy);
    } else {
      view_.MoveCamera(s.right ? move : s.left ? turn : mjMOUSE_ZOOM, dx, dy);
    }
  }

  void Key(const InputEvent& event) {
    constexpr size_t kMostKeys = 64;  // of a program that never takes them
    if (keys.size() < kMostKeys) keys.push_back(event.key);
    switch (event.key) {
      case ' ':
        set_paused(!paused_);
        break;
      case mjKEY_RIGHT:
        if (paused_) once_ = 1;
        break;
      case mjKEY_BACKSPACE:
        ResetScene();
        break;
      case ',':
        pacing_.set_factor(pacing_.factor() > 0 ? std::max(1. / 64, pacing_.factor() / 2) : 1);
        break;
      case '.':
        pacing_.set_factor(pacing_.factor() > 0 ? std::min(64., pacing_.factor() * 2) : 1);
        break;
      case '[':
      case ']':
        NextCamera(event.key == ']' ? 1 : -1);
        break;
      case mjKEY_ESCAPE:
        view_.UseCamera("");
        break;
      case 'D':
        view_.SelectBody("");
        break;
      case 'S':
        screenshot_ = event.control;
        break;
      case 'Q':
        close_ = event.control;
        break;
      case mjKEY_TAB:
        panels_.left_shown = panels_.right_shown = !panels_.left_shown;
        panels_.Layout(window_->width(), window_->height(), &context_);
        break;
      case mjKEY_F1:
        values_.help = !values_.help;
        break;
      case mjKEY_F2:
        values_.timing = !values_.timing;
        break;
      default:
        break;
    }
  }

  void NextCamera(int by) {
    const int count = static_cast<int>(values_.cameras.size());
    view_.UseCamera(values_.cameras[static_cast<size_t>((values_.camera + by + count) % count)]);
    ReadValues();
  }

  void ResetScene() {
    Scene scene = view_.scene();
    scene.Reset();
    view_.traces.Clear();
    view_.Release();
    message_.clear();
  }

  void Act(const Panels::Change& change) {
    const auto row = static_cast<size_t>(change.row);
    switch (change.item) {
      case PanelItem::kRun:
        set_paused(values_.run == 0);
        break;
      case PanelItem::kStepOnce:
        paused_ = true;
        once_ = 1;
        break;
      case PanelItem::kReset:
        ResetScene();
        break;
      case PanelItem::kScreenshot:
        screenshot_ = true;
        break;
      case PanelItem::kClose:
        close_ = true;
        break;
      case PanelItem::kFactor:
        pacing_.set_factor(values_.factor);
        break;
      case PanelItem::kRealTime:
        pacing_.set_factor(1);
        break;
      case PanelItem::kUnpaced:
        pacing_.set_factor(0);
        break;
      case PanelItem::kFrameList:
      case PanelItem::kTraceList:
      case PanelItem::kJointList:
      case PanelItem::kControlList:
        BuildPanels();
        break;
      case PanelItem::kFrame:
        view_.ShowFrame({KindOf(values_.frame_kind), values_.frames.shown[row]},
                        values_.frames.on[row] != 0);
        break;
      case PanelItem::kFrameLength:
        view_.set_frame_length(values_.frame_length);
        break;
      case PanelItem::kNoFrames:
        for (const ViewElement& element : std::set<ViewElement>(view_.frames()))
          view_.ShowFrame(element, false);
        break;
      case PanelItem::kTrace:
        view_.TracePoint({KindOf(values_.trace_kind), values_.traces.shown[row]},
                         values_.traces.on[row] != 0);
        break;
      case PanelItem::kTraceLength:
        view_.traces.set_length(values_.trace_length);
        break;
      case PanelItem::kClearTraces:
        view_.traces.Clear();
        break;
      case PanelItem::kDeselect:
        view_.SelectBody("");
        break;
      case PanelItem::kRecord:
        StartVideo();
        break;
      case PanelItem::kStopRecording:
        video_.Stop();
        break;
      case PanelItem::kCamera:
        if (static_cast<size_t>(values_.camera) < values_.cameras.size())
          view_.UseCamera(values_.cameras[static_cast<size_t>(values_.camera)]);
        break;
      case PanelItem::kFlags:
        view_.flags = {.contacts = values_.contacts != 0,
                       .collision_geoms = values_.collision != 0,
                       .joints = values_.joint_axes != 0,
                       .transparent = values_.transparent != 0,
                       .shadows = values_.shadows != 0,
                       .labels = values_.frame_labels != 0};
        break;
      case PanelItem::kJoint:
        internal::SetJoint(scene(), view_.robots(), values_.joints.shown[row],
                           values_.joints.value[row]);
        break;
      case PanelItem::kControl:
        internal::SetControl(scene(), view_.robots(), values_.controls.shown[row],
                             values_.controls.value[row]);
        break;
      case PanelItem::kOther:
      case PanelItem::kNone:
        break;
    }
  }

  void StartVideo() {
    const auto camera = static_cast<size_t>(values_.video_camera);
    try {
      video_.Start(view_, values_.video_path, std::max(1, values_.video_fps),
                   SizeOf(static_cast<VideoResolution>(values_.video_size)),
                   camera == 0 || camera > values_.cameras.size() ? std::string(kCurrentCamera)
                                                                  : values_.cameras[camera - 1]);
    } catch (const Error& error) {
      video_.Fail(std::string("failed: ") + error.what());
      throw;
    }
  }

  ViewerOptions options_;
  std::string title_;
  std::thread::id thread_;
  SceneView view_;
  internal::PanelValues values_;
  Panels panels_;
  std::unique_ptr<ViewerWindow> window_;
  mjrContext context_ = [] {
    mjrContext context;
    mjr_defaultContext(&context);
    return context;
  }();
  Pacing pacing_;
  internal::ViewerVideo video_;
  std::vector<internal::TcpHandle> handles_;
  std::string message_;
  bool paused_ = false, close_ = false, screenshot_ = false, presenting_ = false, detached_ = false;
  int once_ = 0;  // steps to make while paused
  double step_began_ = 0, step_seconds_ = 0;
};

Viewer Viewer::Open(const Scene& scene, const ViewerOptions& options) {
  return Open(scene, std::vector<Robot>(), options);
}

Viewer Viewer::Open(const Robot& robot, const ViewerOptions& options) {
  return Open(robot.scene(), {robot}, options);
}

Viewer Viewer::Open(const Scene& scene, const std::vector<Robot>& robots,
                    const ViewerOptions& options) {
  if (scene.closed()) throw ClosedError("scene '" + scene.name() + "' is closed");
  if (options.width < 64 || options.height < 64) {
    throw ArgumentError(
        fmt::format("viewer: expected a window of at least 64 x 64 pixels, got {} x {}",
                    options.width, options.height));
  }
  if (options.stops_scene || options.draws_steps) {
    if (const auto other = std::dynamic_pointer_cast<Impl>(scene.FindObserver(kGateKey));
        other && other->is_running()) {
      throw Error(fmt::format("scene '{}' has the viewer '{}' already; close() it first",
                              scene.name(), other->title()));
    }
  }
  auto impl = std::make_shared<Impl>(scene, robots, options);
  Scene(scene).AddObserver(impl, kGateKey);
  return Viewer(std::move(impl));
}

Viewer::Viewer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
Viewer::Viewer(Viewer&&) noexcept = default;
Viewer& Viewer::operator=(Viewer&&) noexcept = default;
Viewer::~Viewer() = default;

Viewer::Impl& Viewer::open() const {
  if (impl_->detached()) throw ClosedError(fmt::format("viewer '{}' is closed", impl_->title()));
  return *impl_;
}

const Scene& Viewer::scene() const { return impl_->scene(); }
const std::string& Viewer::title() const { return impl_->title(); }
bool Viewer::Step() { return impl_->Step(); }
bool Viewer::Show() { return impl_->Show(); }
bool Viewer::is_running() const { return impl_->is_running(); }
void Viewer::Close() { impl_->Detach(); }
double Viewer::realtime_factor() const { return impl_->pacing().factor(); }
void Viewer::set_realtime_factor(double factor) { impl_->pacing().set_factor(factor); }
double Viewer::measured_factor() const { return impl_->pacing().measured(); }
bool Viewer::paused() const { return impl_->paused(); }
void Viewer::set_paused(bool paused) { impl_->set_paused(paused); }
SceneView& Viewer::view() { return open().view(); }
void Viewer::DragTcp(const Robot& robot, bool commands) { open().DragTcp(robot, commands); }

void Viewer::StartRecording(const std::string& path, int fps, VideoSize size,
                            std::string_view camera) {
  Impl& impl = open();
  impl.video().Start(impl.view(), path, fps, size, camera);
}

std::string Viewer::StopRecording() { return impl_->video().Stop(); }
size_t Viewer::scenes_held() const { return impl_->scenes_held(); }
bool Viewer::recording() const { return impl_->video().recording(); }
void Viewer::SaveScreenshot(const std::string& path) { impl_->SaveScreenshot(path); }
std::vector<uint8_t> Viewer::Pixels(int* width, int* height) {
  return impl_->Pixels(width, height);
}
void Viewer::Post(const InputEvent& event) { impl_->Post(event); }
std::pair<double, double> Viewer::PlaceOf(std::string_view section, std::string_view item) {
  return impl_->PlaceOf(section, item);
}
void Viewer::set_text(const std::string& text) { impl_->text = text; }
const std::string& Viewer::text() const { return impl_->text; }
std::vector<int> Viewer::TakeKeys() { return std::exchange(impl_->keys, {}); }
bool Viewer::panels_shown() const { return impl_->panels_shown(); }
void Viewer::SetPanelsShown(bool shown) { impl_->SetPanelsShown(shown); }
void Viewer::ShowPanels(std::string_view left, std::string_view right) {
  impl_->ShowPanels(left, right);
}

}  // namespace robocell
