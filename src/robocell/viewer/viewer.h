// Viewer: a window that shows a scene and lets the user act on it: drag bodies, move joints and
// robots, show frames and paths, record videos, change the speed.
//
//   Viewer viewer = Viewer::Open(robot, {.title = "arm"});
//   while (viewer.Step()) robot.Update();
//
// Step() makes one step of the scene, draws when a picture is due, and waits so that the simulation
// runs at realtime_factor(). The steps of the scene and of its robots do the same while a viewer is
// open. After the user closed the window, Step() returns false, and so do their steps (StepResult::
// kStopped), until the viewer is closed by Close() or destroyed: loops end, the program goes on.
// While the user pauses, no step is made: Step() returns true after the next picture, and the
// scene's steps return StepResult with 0 steps.
//
// It follows resets, and objects that are added or removed. A scene has one viewer at a time; a new
// one replaces one whose window the user closed.
// Throws Error if there can be no window, with what was tried and what to install; ArgumentError,
// NotFoundError and ClosedError like scene_view.h. Threads: the one that opened it; steps of other
// threads draw nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/render/video_recorder.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/viewer/scene_view.h"
#include "robocell/viewer/window.h"

namespace robocell {

struct ViewerOptions {
  std::string title = {};  // empty: the scene's name
  int width = 1280, height = 720;
  // False: no window but a picture in memory, for tests and documents.
  bool on_screen = true;
  // False: the steps of the scene go on when the user closes the window, and the user can neither
  // pause nor reset. It is false for every scene that an environment or a rollout steps, whose
  // episodes do not end by a window.
  bool stops_scene = true;
  // False: only Show() draws, and steps of the scene do not wait. The program itself goes by
  // paused() and realtime_factor(), and the user cannot reset the scene.
  bool draws_steps = true;
};

class Viewer {
 public:
  static Viewer Open(const Scene& scene, const ViewerOptions& options = {});
  // Shows the robot's scene, and the robot among those that have TCP frames, paths and sliders.
  static Viewer Open(const Robot& robot, const ViewerOptions& options = {});
  static Viewer Open(const Scene& scene, const std::vector<Robot>& robots,
                     const ViewerOptions& options = {});

  Viewer(Viewer&&) noexcept;
  Viewer& operator=(Viewer&&) noexcept;
  ~Viewer();

  const Scene& scene() const;
  const std::string& title() const;
  // Makes one step, draws if a picture is due, and waits. False once the window was closed. A step
  // that diverges pauses the simulation, and the window shows the reason.
  bool Step();
  // Handles the user's input and draws now, without a step. False once the window was closed.
  bool Show();
  // False once the user or Close() closed the window, or the scene was closed.
  bool is_running() const;
  // Closes the window. The scene can be stepped as before. May be repeated.
  void Close();

  // 1: real time; 0: as fast as possible.
  double realtime_factor() const;
  void set_realtime_factor(double factor);
  // Returns the factor of about the last second; 0 before anything was measured.
  double measured_factor() const;
  bool paused() const;
  // Throws Error if the viewer does not stop its scene (ViewerOptions).
  void set_paused(bool paused);

  // Camera, frames, paths and flags.
  SceneView& view();
  // Lets the user drag a robot's TCP with the mouse: a handle appears there, and inverse kinematics
  // moves the robot's command; without `commands` it moves the arm itself. Call Robot::Update() in
  // the loop. Throws NotFoundError for a robot without an arm, ArgumentError for one of another
  // scene.
  void DragTcp(const Robot& robot, bool commands = true);

  // Shows a text in the upper right corner until the next call.
  void set_text(const std::string& text);
  const std::string& text() const;
  // Returns the keys that the user pressed since the last call, by GLFW's numbers, the newest 64.
  std::vector<int> TakeKeys();

  // Starts a video of the scene, with one picture for each 1 / fps seconds of simulation. The
  // camera is one of camera_names() or "Current", which follows the viewer's. Throws the errors of
  // SceneRecorder, and Error if a video is being recorded.
  void StartRecording(const std::string& path, int fps = 30,
                      VideoSize size = SizeOf(VideoResolution::kR720p),
                      std::string_view camera = kCurrentCamera);
  // Completes the file and returns its path; "" if nothing is being recorded.
  std::string StopRecording();
  bool recording() const;

  // Writes the whole window as a PNG.
  void SaveScreenshot(const std::string& path);
  // Returns the window's picture, rows from the top, 3 bytes a pixel.
  std::vector<uint8_t> Pixels(int* width, int* height);
  // Returns how many handles to its scene it holds, for garbage collectors of other languages.
  size_t scenes_held() const;
  // Acts as the user would, with the next Show() or Step().
  void Post(const InputEvent& event);
  // Returns the middle of an item of the panels, by the names of its section and of the item, after
  // opening the section; for tests and pictures. Throws NotFoundError with the names.
  std::pair<double, double> PlaceOf(std::string_view section, std::string_view item);
  // Shows or hides the panels, as Tab does.
  void SetPanelsShown(bool shown);
  bool panels_shown() const;
  // Opens one section of the panels on each side, and closes the others.
  void ShowPanels(std::string_view left, std::string_view right);

 private:
  class Impl;
  explicit Viewer(std::shared_ptr<Impl> impl);
  Impl& open() const;  // throws ClosedError
  std::shared_ptr<Impl> impl_;
};

}  // namespace robocell
