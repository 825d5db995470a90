// What the user does: the mouse, the keys, the panels.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/render/video_recorder.h"
#include "robocell/scene/scene.h"
#include "robocell/viewer/edit_values.h"
#include "robocell/viewer/panels.h"
#include "robocell/viewer/scene_view.h"
#include "robocell/viewer/tcp_handle.h"
#include "robocell/viewer/viewer_impl.h"
#include "robocell/viewer/window.h"

namespace robocell {
namespace {

using internal::PanelItem;
using internal::Panels;

// Returns "a_003.png" for "a.png" and 3.
std::string Numbered(const std::string& path, int number) {
  const std::filesystem::path given(path);
  return (given.parent_path() /
          fmt::format("{}_{:03}{}", given.stem().string(), number, given.extension().string()))
      .string();
}

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error) && !error;
}

}  // namespace

// With the window's context current.
void Viewer::Impl::HandleInput() {
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
}

void Viewer::Impl::DoLater() {
  for (const std::function<void()>& act : std::exchange(later_, {})) {
    try {
      if (window_) act();
    } catch (const Error& error) {
      message_ = error.what();
    }
  }
}

void Viewer::Impl::Handle(const InputEvent& event) {
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

Eigen::Vector2d Viewer::Impl::Place() const {
  const mjuiState& s = panels_.state();
  const mjrRect& rect = panels_.scene_rect();
  return {(s.x - rect.left) / std::max(1, rect.width),
          (s.y - rect.bottom) / std::max(1, rect.height)};
}

void Viewer::Impl::Press(double aspect) {
  const mjuiState& s = panels_.state();
  if (s.doubleclick) {
    view_.Select(Place().x(), Place().y(), aspect);
    return;
  }
  if (s.button == mjBUTTON_LEFT && !s.control) {
    for (internal::TcpHandle& handle : handles_) {
      if (handle.Grab(view_, Place(), aspect)) return;
    }
  }
  if (view_.selected().empty() || (!s.control && values_.drag == 0)) return;
  const bool turns = s.control ? s.button == mjBUTTON_LEFT : values_.drag == 2;
  view_.Hold(turns);
}

void Viewer::Impl::Mouse(const InputEvent& event) {
  const mjuiState& s = panels_.state();
  const mjrRect& rect = panels_.scene_rect();
  const double height = std::max(1, rect.height);
  if (event.type == InputEvent::kScroll) {
    if (s.mouserect == 3) view_.MoveCamera(mjMOUSE_ZOOM, 0, -0.05 * s.sy);
    return;
  }
  if (event.type == InputEvent::kPress && s.mouserect == 3) return Press(rect.width / height);
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

void Viewer::Impl::Key(const InputEvent& event) {
  constexpr size_t kMostKeys = 64;  // of a program that never takes them: the newest
  if (keys_.size() >= kMostKeys) keys_.erase(keys_.begin());
  keys_.push_back(event.key);
  const double factor = pacing_.factor();
  switch (event.key) {
    case ' ':
      if (pauses()) SetPaused(!paused_);
      break;
    case mjKEY_RIGHT:
      if (paused_ && resets()) once_ = 1;
      break;
    case mjKEY_BACKSPACE:
      if (resets()) ActLater([this] { ResetScene(); });
      break;
    case ',':
      if (paces()) pacing_.set_factor(factor > 0 ? std::max(1. / 64, factor / 2) : 1);
      break;
    case '.':
      if (paces()) pacing_.set_factor(factor > 0 ? std::min(64., factor * 2) : 1);
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
      if (event.control) ActLater([this] { SaveNumberedScreenshot(); });
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

void Viewer::Impl::NextCamera(int by) {
  const std::vector<std::string> names = view_.camera_names();
  const auto count = static_cast<ptrdiff_t>(names.size());
  const ptrdiff_t now = std::find(names.begin(), names.end(), view_.camera()) - names.begin();
  view_.UseCamera(names[static_cast<size_t>((now + by + count) % count)]);
}

void Viewer::Impl::Act(const Panels::Change& change) {
  const auto row = static_cast<size_t>(change.row);
  switch (change.item) {
    case PanelItem::kRun:
      SetPaused(values_.run == 0);
      break;
    case PanelItem::kStepOnce:
      paused_ = true;
      once_ = 1;
      break;
    case PanelItem::kReset:
      ActLater([this] { ResetScene(); });
      break;
    case PanelItem::kScreenshot:
      ActLater([this] { SaveNumberedScreenshot(); });
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
    case PanelItem::kCameraList:
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
      ActLater([this] { StartVideo(); });
      break;
    case PanelItem::kStopRecording:
      ActLater([this] { video_.Stop(); });
      break;
    case PanelItem::kCamera:
      values_.cameras.TakeIndex();
      view_.UseCamera(values_.cameras.chosen);
      break;
    case PanelItem::kVideoCamera:
      values_.video_cameras.TakeIndex();
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
      ActLater([this, name = values_.joints.shown[row], value = values_.joints.value[row]] {
        internal::SetJoint(scene(), view_.robots(), name, value);
      });
      break;
    case PanelItem::kControl:
      ActLater([this, name = values_.controls.shown[row], value = values_.controls.value[row]] {
        internal::SetControl(scene(), view_.robots(), name, value);
      });
      break;
    case PanelItem::kOther:
    case PanelItem::kNone:
      break;
  }
}

void Viewer::Impl::ResetScene() {
  Scene scene = view_.scene();
  view_.Release();
  message_.clear();
  scene.Reset();
  view_.traces.Clear();
}

void Viewer::Impl::StartVideo() {
  std::string path = values_.video_path;
  for (int i = 1; Exists(path); ++i) path = Numbered(values_.video_path, i);
  try {
    video_.Start(view_, path, std::max(1, values_.video_fps),
                 SizeOf(static_cast<VideoResolution>(values_.video_size)),
                 values_.video_cameras.chosen);
  } catch (const Error& error) {
    if (!video_.recording()) video_.Fail(std::string("failed: ") + error.what());
    throw;
  }
}

void Viewer::Impl::SaveNumberedScreenshot() {
  const std::string name = "screenshot.png";
  int number = 1;
  while (Exists(Numbered(name, number))) ++number;
  SaveScreenshot(Numbered(name, number));
  message_ = "saved " + Numbered(name, number);
}

}  // namespace robocell
