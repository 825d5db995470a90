// Panels: the widgets at both sides of a viewer's window, by MuJoCo's own interface (mjUI). They
// show and change values; what else has to happen is done by PanelActions. Internal to viewer/.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/viewer/window.h"

namespace robocell::internal {

// Names with a filter, of which the panels show some rows at a time.
struct NameRows {
  static constexpr int kRows = 12;

  std::function<std::vector<std::string>()> all;  // by the present scene
  char filter[mjMAXUITEXT] = "";
  int page = 0;
  std::vector<std::string> shown;  // at most kRows
  int pages = 1;
  std::array<int, kRows> on = {};        // check boxes
  std::array<double, kRows> value = {};  // sliders
  // Returns the names that contain the filter; case does not count.
  void Choose();
};

// A choice among names, in a box that holds only some of them: as many as fit, by the page. Beside
// these it offers the chosen one.
struct NameChoice {
  std::function<std::vector<std::string>()> all;  // by the present scene
  std::string chosen;
  char filter[mjMAXUITEXT] = "";
  int page = 0;
  int pages = 1;
  std::vector<std::string> shown;
  int index = 0;  // of the chosen one among those shown
  // Fills `shown` and `index`.
  void Choose();
  // Chooses the one at `index`.
  void TakeIndex();
};

// A joint or actuator for a slider.
struct SliderRange {
  double low = 0, high = 1;
};

// What the panels show; the viewer writes it before each picture, and reads it after an event.
struct PanelValues {
  // What the user may do; the rest is not offered.
  bool pauses = true, resets = true, paces = true;
  int run = 1;
  double factor = 1;
  int frame_kind = 0, trace_kind = 2;  // ViewElement::Kind
  NameRows frames, traces, joints, controls;
  double frame_length = 0.1, trace_length = 5;
  int frame_labels = 1;
  int drag = 0;  // 0 camera, 1 force, 2 torque
  char video_path[mjMAXUITEXT] = "recording.mp4";
  int video_size = 2, video_fps = 30;
  NameChoice cameras, video_cameras;  // "Free", "Tracking", ...; "Current" and these
  int contacts = 0, collision = 0, joint_axes = 0, transparent = 0, shadows = 1;
  int help = 0, timing = 1;
  // Texts of the panels.
  std::string measured, selected, video_state;
};

// Which item changed.
enum class PanelItem {
  kNone,
  kRun,
  kReset,
  kStepOnce,
  kScreenshot,
  kClose,
  kFactor,
  kRealTime,
  kUnpaced,
  kFrameList,
  kFrame,
  kFrameLength,
  kNoFrames,
  kTraceList,
  kTrace,
  kTraceLength,
  kClearTraces,
  kDeselect,
  kRecord,
  kStopRecording,
  kVideoCamera,
  kCameraList,
  kCamera,
  kFlags,
  kJointList,
  kJoint,
  kControlList,
  kControl,
  kOther,
};

class Panels {
 public:
  struct Change {
    PanelItem item = PanelItem::kNone;
    int row = 0;        // of kFrame, kTrace, kJoint, kControl
    bool used = false;  // the event was for the panels
  };

  explicit Panels(PanelValues& values);

  // Calls with the drawing context current. `joint` and `control` give the ranges of the sliders.
  using Range = std::function<SliderRange(const std::string&)>;
  void Build(const mjrContext* context, int width, int height, const Range& joint,
             const Range& control);
  void Layout(int width, int height, const mjrContext* context);
  // Updates the state by the event and passes it to the panels.
  Change Handle(const InputEvent& event, double now, const mjrContext* context);
  void Draw(const mjrContext* context);

  bool left_shown = true, right_shown = true;
  // How long a picture takes: clicks are seen only between pictures.
  double picture_seconds = 0;
  // The rectangle of the simulation.
  const mjrRect& scene_rect() const { return state_.rect[3]; }
  const mjuiState& state() const { return state_; }
  mjuiState& state() { return state_; }
  std::pair<double, double> PlaceOf(std::string_view section, std::string_view item,
                                    const mjrContext* context);
  void ShowOnly(std::string_view left, std::string_view right, const mjrContext* context);

 private:
  struct Entry {
    PanelItem item = PanelItem::kOther;
    int row = 0;
  };
  void Section(mjUI& ui, const char* name, bool open);
  void Item(mjUI& ui, int type, std::string_view name, void* data, const std::string& other,
            PanelItem item, int row = 0, int state = 1);
  void List(mjUI& ui, NameRows& rows, PanelItem list);
  void Choice(mjUI& ui, std::string_view name, NameChoice& choice, PanelItem item);
  void AddRun(mjUI& ui);
  void AddSpeed(mjUI& ui);
  void AddRecorder(mjUI& ui);
  void AddView(mjUI& ui);
  void Modify(mjUI& ui, const mjrContext* context);
  void SetText(std::string_view section, std::string_view item, const std::string& text,
               const mjrContext* context);
  mjuiItem* Find(std::string_view section, std::string_view item, mjUI** ui);
  void Track(const InputEvent& event, double now);

  PanelValues& values_;
  std::unique_ptr<mjUI> left_, right_;
  std::vector<Entry> entries_;  // by userid
  mjuiState state_ = {};
};

}  // namespace robocell::internal
