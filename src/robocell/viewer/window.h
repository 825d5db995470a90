// ViewerWindow: where a viewer draws and where its input comes from: a window of the desktop (GLFW,
// loaded at run time), or a picture in memory for tests, documentation and machines without a
// display. Internal to viewer/.
//
//   std::unique_ptr<ViewerWindow> window = OpenDesktopWindow("cell", 1280, 720);
//   {
//     const ViewerWindow::Current current(*window);   // its OpenGL context, until the end
//     ... mjr_render(...) ...
//     window->Show();
//   }
//   for (const InputEvent& event : window->Poll()) ...
//
// Sizes and places are in pixels of the picture, from its lower left corner, as MuJoCo's interface
// takes them. Throws Error, with what was tried and what to install, if there can be no window.
// Threads: one at a time; events arrive on the thread that polls.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace robocell {

struct InputEvent {
  enum Type { kMove, kPress, kRelease, kScroll, kKey, kResize, kClose };
  Type type = kMove;
  double x = 0, y = 0;  // of the mouse; of kScroll: the steps
  int button = 0;       // mjtButton
  int key = 0;          // of GLFW, which are MuJoCo's
  bool control = false, shift = false, alt = false;
};

class ViewerWindow {
 public:
  virtual ~ViewerWindow() = default;
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;

  virtual int width() const = 0;
  virtual int height() const = 0;
  // True if the picture is the off-screen buffer of the drawing context.
  virtual bool offscreen() const = 0;
  // Returns the events since the last call.
  virtual std::vector<InputEvent> Poll() = 0;
  // Shows what was drawn.
  virtual void Show() = 0;
  virtual void SetTitle(const std::string& title) = 0;
  // Returns how large letters should be, in percent.
  virtual int font_percent() const { return 100; }
  // Adds an event, as if it came from the user.
  void Post(const InputEvent& event) { posted_.push_back(event); }

  // Makes its OpenGL context current until the end of the scope; then that of the window that was
  // current before, if any.
  class Current {
   public:
    explicit Current(ViewerWindow& window) : window_(window) { window_.Enter(); }
    ~Current() { window_.Leave(); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    ViewerWindow& window_;
  };

 protected:
  ViewerWindow() = default;
  virtual void Enter() = 0;
  virtual void Leave() noexcept = 0;
  std::vector<InputEvent> posted_;
};

std::unique_ptr<ViewerWindow> OpenDesktopWindow(const std::string& title, int width, int height);
std::unique_ptr<ViewerWindow> OpenOffscreenWindow(int width, int height);

// Adds a file that is tried for GLFW after the system's libraries, such as that of a Python package.
void AddGlfwLibrary(const std::string& path);

}  // namespace robocell
