// A window of the desktop. GLFW is opened at run time, and the few names of it that are needed are
// declared here: building robocell needs no GLFW, and machines without a display need none either.
#include <dlfcn.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/render/gl_backends.h"
#include "robocell/viewer/window.h"

namespace robocell {
namespace {

struct GlfwHandle;  // GLFWwindow

constexpr int kVisible = 0x00020004, kScaleToMonitor = 0x0002200C, kSamples = 0x0002100D;
constexpr int kDoubleBuffer = 0x00021010;
constexpr int kPressed = 1, kReleased = 0, kRepeated = 2;
constexpr int kShift = 1, kControl = 2, kAlt = 4;

using ErrorCallback = void (*)(int, const char*);
using SizeCallback = void (*)(GlfwHandle*, int, int);
using PlaceCallback = void (*)(GlfwHandle*, double, double);
using ButtonCallback = void (*)(GlfwHandle*, int, int, int);
using KeyCallback = void (*)(GlfwHandle*, int, int, int, int);
using CloseCallback = void (*)(GlfwHandle*);

std::vector<std::string>& MoreLibraries() {
  static std::vector<std::string> paths;
  return paths;
}

struct Glfw {
  int (*Init)();
  int (*GetError)(const char**);
  void (*WindowHint)(int, int);
  void (*DefaultWindowHints)();
  GlfwHandle* (*CreateWindow)(int, int, const char*, void*, GlfwHandle*);
  void (*DestroyWindow)(GlfwHandle*);
  void (*MakeContextCurrent)(GlfwHandle*);
  GlfwHandle* (*GetCurrentContext)();
  void (*SwapBuffers)(GlfwHandle*);
  void (*SwapInterval)(int);
  void (*PollEvents)();
  void (*SetWindowTitle)(GlfwHandle*, const char*);
  void (*SetWindowUserPointer)(GlfwHandle*, void*);
  void* (*GetWindowUserPointer)(GlfwHandle*);
  void (*GetFramebufferSize)(GlfwHandle*, int*, int*);
  void (*GetWindowSize)(GlfwHandle*, int*, int*);
  void (*GetWindowContentScale)(GlfwHandle*, float*, float*);
  int (*GetKey)(GlfwHandle*, int);
  SizeCallback (*SetFramebufferSizeCallback)(GlfwHandle*, SizeCallback);
  PlaceCallback (*SetCursorPosCallback)(GlfwHandle*, PlaceCallback);
  PlaceCallback (*SetScrollCallback)(GlfwHandle*, PlaceCallback);
  ButtonCallback (*SetMouseButtonCallback)(GlfwHandle*, ButtonCallback);
  KeyCallback (*SetKeyCallback)(GlfwHandle*, KeyCallback);
  CloseCallback (*SetWindowCloseCallback)(GlfwHandle*, CloseCallback);

  explicit Glfw(void* library) : library_(library) {
    Load(Init, "glfwInit");
    Load(GetError, "glfwGetError");
    Load(WindowHint, "glfwWindowHint");
    Load(DefaultWindowHints, "glfwDefaultWindowHints");
    Load(CreateWindow, "glfwCreateWindow");
    Load(DestroyWindow, "glfwDestroyWindow");
    Load(MakeContextCurrent, "glfwMakeContextCurrent");
    Load(GetCurrentContext, "glfwGetCurrentContext");
    Load(SwapBuffers, "glfwSwapBuffers");
    Load(SwapInterval, "glfwSwapInterval");
    Load(PollEvents, "glfwPollEvents");
    Load(SetWindowTitle, "glfwSetWindowTitle");
    Load(SetWindowUserPointer, "glfwSetWindowUserPointer");
    Load(GetWindowUserPointer, "glfwGetWindowUserPointer");
    Load(GetFramebufferSize, "glfwGetFramebufferSize");
    Load(GetWindowSize, "glfwGetWindowSize");
    Load(GetWindowContentScale, "glfwGetWindowContentScale");
    Load(GetKey, "glfwGetKey");
    Load(SetFramebufferSizeCallback, "glfwSetFramebufferSizeCallback");
    Load(SetCursorPosCallback, "glfwSetCursorPosCallback");
    Load(SetScrollCallback, "glfwSetScrollCallback");
    Load(SetMouseButtonCallback, "glfwSetMouseButtonCallback");
    Load(SetKeyCallback, "glfwSetKeyCallback");
    Load(SetWindowCloseCallback, "glfwSetWindowCloseCallback");
  }

  // Returns the last error and forgets it.
  std::string Error() const {
    const char* text = nullptr;
    GetError(&text);
    return text ? text : "no reason given";
  }

 private:
  template <class Function>
  void Load(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(dlsym(library_, name));
    if (!function) throw IoError(std::string("it lacks ") + name + "; GLFW 3.3 or newer is needed");
  }
  void* library_;
};

constexpr const char* kInstall =
    "Install GLFW (Debian, Ubuntu: sudo apt install libglfw3; any system: pip install glfw).";

// Returns the library, opened and initialised once per process. It is never terminated: windows
// come and go without it.
const Glfw& OpenGlfw() {
  static std::mutex mutex;
  static const Glfw* glfw = nullptr;
  static bool ready = false;
  const std::lock_guard lock(mutex);
  if (!glfw) {
    std::string tried;
    std::vector<std::string> paths;
    if (const char* path = std::getenv("ROBOCELL_GLFW"); path && *path) paths.emplace_back(path);
    if (paths.empty()) {
      paths = {"libglfw.so.3", "libglfw.so"};
      paths.insert(paths.end(), MoreLibraries().begin(), MoreLibraries().end());
    }
    for (const std::string& path : paths) {
      void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (!library) {
        tried += fmt::format("\n  {}", dlerror());
        continue;
      }
      try {
        glfw = new Glfw(library);
        break;
      } catch (const IoError& error) {
        tried += fmt::format("\n  {}: {}", path, error.what());
      }
    }
    if (!glfw)
      throw Error(
          fmt::format("viewer: no window: GLFW was not found. Tried:{}\n{}", tried, kInstall));
  }
  if (!ready) {
    const auto shown = [](const char* name) {
      const char* value = std::getenv(name);
      return fmt::format("{}={}", name, value && *value ? value : "(not set)");
    };
    if (!glfw->Init()) {
      throw Error(fmt::format(
          "viewer: no window: {} ({}, {}). Start the program on a desktop, or by `ssh -X`, or in a "
          "virtual display: `xvfb-run -a python program.py` (Debian, Ubuntu: sudo apt install "
          "xvfb). Videos and pictures need no display: VideoRecorder, Renderer",
          glfw->Error(), shown("DISPLAY"), shown("WAYLAND_DISPLAY")));
    }
    ready = true;
  }
  return *glfw;
}

class GlfwWindow final : public ViewerWindow {
 public:
  GlfwWindow(const Glfw& glfw, const std::string& title, int width, int height) : glfw_(glfw) {
    glfw_.DefaultWindowHints();
    glfw_.WindowHint(kVisible, 1);
    glfw_.WindowHint(kScaleToMonitor, 1);
    glfw_.WindowHint(kDoubleBuffer, 1);
    for (const int samples : {4, 0}) {  // some drivers have no multisampling
      glfw_.WindowHint(kSamples, samples);
      window_ = glfw_.CreateWindow(width, height, title.c_str(), nullptr, nullptr);
      if (window_) break;
    }
    if (!window_) {
      throw Error(fmt::format(
          "viewer: the display opens no window with OpenGL: {}. Install the driver of the graphics "
          "card, or Mesa's (Debian, Ubuntu: sudo apt install libgl1-mesa-dri libgl1)",
          glfw_.Error()));
    }
    glfw_.SetWindowUserPointer(window_, this);
    glfw_.SetFramebufferSizeCallback(
        window_, [](GlfwHandle* w, int, int) { Of(w).Add({.type = InputEvent::kResize}); });
    glfw_.SetCursorPosCallback(window_, [](GlfwHandle* w, double x, double y) {
      Of(w).Add({.type = InputEvent::kMove, .x = x, .y = y});
    });
    glfw_.SetScrollCallback(window_, [](GlfwHandle* w, double x, double y) {
      Of(w).Add({.type = InputEvent::kScroll, .x = x, .y = y});
    });
    glfw_.SetMouseButtonCallback(window_, [](GlfwHandle* w, int button, int action, int mods) {
      constexpr int kButtons[] = {mjBUTTON_LEFT, mjBUTTON_RIGHT, mjBUTTON_MIDDLE};
      if (button < 0 || button > 2) return;
      Of(w).Add({.type = action == kReleased ? InputEvent::kRelease : InputEvent::kPress,
                 .button = kButtons[button],
                 .control = (mods & kControl) != 0,
                 .shift = (mods & kShift) != 0,
                 .alt = (mods & kAlt) != 0});
    });
    glfw_.SetKeyCallback(window_, [](GlfwHandle* w, int key, int, int action, int mods) {
      if (action != kPressed && action != kRepeated) return;
      Of(w).Add({.type = InputEvent::kKey,
                 .key = key,
                 .control = (mods & kControl) != 0,
                 .shift = (mods & kShift) != 0,
                 .alt = (mods & kAlt) != 0});
    });
    glfw_.SetWindowCloseCallback(window_,
                                 [](GlfwHandle* w) { Of(w).Add({.type = InputEvent::kClose}); });
    Enter();
    glfw_.SwapInterval(0);  // the viewer paces itself
    Leave();
    // MuJoCo looks its GL functions up among the global symbols of the process.
    internal::GlLibrary{"libGL.so.1", "libGL.so", "libEGL.so.1"}.MakeGlobal();
  }
  ~GlfwWindow() override { glfw_.DestroyWindow(window_); }

  int width() const override { return FramebufferSize().first; }
  int height() const override { return FramebufferSize().second; }
  bool offscreen() const override { return false; }
  std::vector<InputEvent> Poll() override {
    glfw_.PollEvents();
    return std::exchange(posted_, {});
  }
  void Show() override { glfw_.SwapBuffers(window_); }
  void SetTitle(const std::string& title) override { glfw_.SetWindowTitle(window_, title.c_str()); }
  int font_percent() const override {
    float x = 1, y = 1;
    glfw_.GetWindowContentScale(window_, &x, &y);
    return 50 * std::clamp(static_cast<int>(2 * x), 2, 6);
  }

 private:
  static GlfwWindow& Of(GlfwHandle* window) {
    // Every window of this process that calls back is one of these.
    return *static_cast<GlfwWindow*>(OpenGlfw().GetWindowUserPointer(window));
  }

  std::pair<int, int> FramebufferSize() const {
    int width = 0, height = 0;
    glfw_.GetFramebufferSize(window_, &width, &height);
    return {width, height};
  }

  // Notes an event, with its place in pixels of the picture.
  void Add(InputEvent event) {
    const auto [pixels, rows] = FramebufferSize();
    int width = 0, height = 0;
    glfw_.GetWindowSize(window_, &width, &height);
    if (event.type == InputEvent::kMove && width > 0 && height > 0) {
      place_x_ = event.x * pixels / width;
      place_y_ = rows - event.y * rows / height;
    }
    if (event.type != InputEvent::kScroll) {
      event.x = place_x_;
      event.y = place_y_;
    }
    if (event.type == InputEvent::kMove || event.type == InputEvent::kScroll) {
      const auto held = [&](int left, int right) {
        return glfw_.GetKey(window_, left) == kPressed || glfw_.GetKey(window_, right) == kPressed;
      };
      event.shift = held(340, 344);
      event.control = held(341, 345);
      event.alt = held(342, 346);
    }
    posted_.push_back(event);
  }

  void Enter() override {
    previous_.push_back(glfw_.GetCurrentContext());
    glfw_.MakeContextCurrent(window_);
  }
  void Leave() noexcept override {
    glfw_.MakeContextCurrent(previous_.back());
    previous_.pop_back();
  }

  const Glfw& glfw_;
  GlfwHandle* window_ = nullptr;
  std::vector<GlfwHandle*> previous_;  // contexts that are current again afterwards
  double place_x_ = 0, place_y_ = 0;
};

}  // namespace

void AddGlfwLibrary(const std::string& path) {
  auto& paths = MoreLibraries();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) paths.push_back(path);
}

std::unique_ptr<ViewerWindow> OpenDesktopWindow(const std::string& title, int width, int height) {
  return std::make_unique<GlfwWindow>(OpenGlfw(), title, width, height);
}

}  // namespace robocell
