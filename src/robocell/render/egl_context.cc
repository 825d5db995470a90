// EGL without a window: a context on a graphics card, else on Mesa's software device, else on
// Mesa's surfaceless platform, else on the default display. The few EGL names needed are declared
// here, so that building needs no GL headers.
#include "robocell/render/gl_backends.h"

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/render/egl_devices.h"

namespace robocell::internal {
namespace {

using Display = void*;
using Handle = void*;
using Bool = unsigned int;
using Enum = unsigned int;
using Int = std::int32_t;
using Attrib = std::intptr_t;

constexpr Enum kOpenGlApi = 0x30A2;
constexpr Enum kPlatformDevice = 0x313F;
constexpr Enum kPlatformSurfaceless = 0x31DD;
constexpr Int kDraw = 0x3059, kRead = 0x305A;
constexpr Int kNone = 0x3038;
// red, green, blue, alpha 8; depth 24; stencil 8; RGB buffers; pbuffers; desktop OpenGL.
constexpr Int kConfig[] = {0x3024, 8, 0x3023, 8,      0x3022, 8, 0x3021, 8, 0x3025, 24,
                           0x3026, 8, 0x303F, 0x308E, 0x3033, 1, 0x3040, 8, kNone};
constexpr Enum kRendererName = 0x1F01, kVersionName = 0x1F02;
constexpr Int kVendor = 0x3053, kExtensions = 0x3055, kCudaDevice = 0x323A;

struct Egl {
  GlLibrary library{"libEGL.so.1", "libEGL.so"};
  void* (*GetProcAddress)(const char*);
  Int (*GetError)();
  Display (*GetDisplay)(void*);
  Bool (*Initialize)(Display, Int*, Int*);
  Bool (*BindAPI)(Enum);
  Enum (*QueryAPI)();
  Bool (*ChooseConfig)(Display, const Int*, Handle*, Int, Int*);
  Handle (*CreateContext)(Display, Handle, Handle, const Int*);
  Bool (*DestroyContext)(Display, Handle);
  Bool (*MakeCurrent)(Display, Handle, Handle, Handle);
  Handle (*GetCurrentContext)();
  Display (*GetCurrentDisplay)();
  Handle (*GetCurrentSurface)(Int);
  // Extensions; null where they are missing.
  Display (*GetPlatformDisplay)(Enum, void*, const Int*) = nullptr;
  Bool (*QueryDevices)(Int, Handle*, Int*) = nullptr;
  const char* (*QueryDeviceString)(Handle, Int) = nullptr;
  Bool (*QueryDeviceAttrib)(Handle, Int, Attrib*) = nullptr;

  Egl() {
    library.Load(GetProcAddress, "eglGetProcAddress");
    library.Load(GetError, "eglGetError");
    library.Load(GetDisplay, "eglGetDisplay");
    library.Load(Initialize, "eglInitialize");
    library.Load(BindAPI, "eglBindAPI");
    library.Load(QueryAPI, "eglQueryAPI");
    library.Load(ChooseConfig, "eglChooseConfig");
    library.Load(CreateContext, "eglCreateContext");
    library.Load(DestroyContext, "eglDestroyContext");
    library.Load(MakeCurrent, "eglMakeCurrent");
    library.Load(GetCurrentContext, "eglGetCurrentContext");
    library.Load(GetCurrentDisplay, "eglGetCurrentDisplay");
    library.Load(GetCurrentSurface, "eglGetCurrentSurface");
    Extension(GetPlatformDisplay, "eglGetPlatformDisplayEXT");
    Extension(QueryDevices, "eglQueryDevicesEXT");
    Extension(QueryDeviceString, "eglQueryDeviceStringEXT");
    Extension(QueryDeviceAttrib, "eglQueryDeviceAttribEXT");
  }

 private:
  template <class Function>
  void Extension(Function*& function, const char* name) {
    function = reinterpret_cast<Function*>(GetProcAddress(name));
  }
};

Egl& egl() {
  static Egl* functions = new Egl;  // throws again on the next call when the library is missing
  return *functions;
}

std::string ErrorText(const char* call) {
  static const char* const kNames[] = {
      "success",           "EGL_NOT_INITIALIZED",     "EGL_BAD_ACCESS",
      "EGL_BAD_ALLOC",     "EGL_BAD_ATTRIBUTE",       "EGL_BAD_CONFIG",
      "EGL_BAD_CONTEXT",   "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY",
      "EGL_BAD_MATCH",     "EGL_BAD_NATIVE_PIXMAP",   "EGL_BAD_NATIVE_WINDOW",
      "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE"};
  const Int code = egl().GetError() - 0x3000;
  return std::string(call) + " failed: " +
         (code >= 0 && code < 14 ? kNames[code] : "error " + std::to_string(code + 0x3000));
}

struct Candidate {
  std::string name;
  Display display;
  // True for a device that does not declare itself as software. Its driver may still only have
  // software.
  bool may_be_hardware = false;
};

// Returns true if a space-separated list of extensions contains this one.
bool HasExtension(const std::string& extensions, const std::string& name) {
  return (" " + extensions + " ").find(" " + name + " ") != std::string::npos;
}

EglDevice Describe(Handle device) {
  Egl& e = egl();
  EglDevice out;
  if (!e.QueryDeviceString) return out;
  const char* list = e.QueryDeviceString(device, kExtensions);
  const std::string extensions = list ? list : "";
  out.software = HasExtension(extensions, "EGL_MESA_device_software");
  if (HasExtension(extensions, "EGL_EXT_device_query_name")) {
    const char* vendor = e.QueryDeviceString(device, kVendor);
    out.vendor = vendor ? vendor : "";
  }
  Attrib cuda = 0;
  if (e.QueryDeviceAttrib && HasExtension(extensions, "EGL_NV_device_cuda") &&
      e.QueryDeviceAttrib(device, kCudaDevice, &cuda))
    out.cuda = static_cast<int>(cuda);
  return out;
}

std::vector<Candidate> Candidates() {
  std::vector<Candidate> out;
  Egl& e = egl();
  if (e.GetPlatformDisplay && e.QueryDevices) {
    Handle handles[32];
    Int count = 0;
    if (!e.QueryDevices(32, handles, &count)) count = 0;
    std::vector<EglDevice> devices;
    for (Int i = 0; i < count; ++i) devices.push_back(Describe(handles[i]));
    const EglDeviceChoice choice = EglDeviceChoice::FromEnvironment();
    for (const size_t i : OrderEglDevices(devices, choice)) {
      out.push_back({DescribeEglDevice(devices, i),
                     e.GetPlatformDisplay(kPlatformDevice, handles[i], nullptr),
                     !devices[i].software});
    }
    if (!choice.robocell_device.empty() || !choice.mujoco_device.empty()) return out;
  }
  if (e.GetPlatformDisplay) {
    out.push_back(
        {"surfaceless Mesa", e.GetPlatformDisplay(kPlatformSurfaceless, nullptr, nullptr)});
  }
  out.push_back({"default display", e.GetDisplay(nullptr)});
  return out;
}

struct Opened {
  Display display = nullptr;
  Handle context = nullptr;
};

// Opens a context on the display that can be made current without a surface. Throws IoError.
Opened Open(Display display) {
  Egl& e = egl();
  if (!display) throw IoError("not supported");
  if (!e.Initialize(display, nullptr, nullptr)) throw IoError(ErrorText("eglInitialize"));
  if (!e.BindAPI(kOpenGlApi)) throw IoError("no desktop OpenGL");
  Handle config = nullptr;
  Int count = 0;
  if (!e.ChooseConfig(display, kConfig, &config, 1, &count) || count < 1)
    throw IoError("no usable configuration");
  Opened opened{display, e.CreateContext(display, config, nullptr, nullptr)};
  if (!opened.context) throw IoError(ErrorText("eglCreateContext"));
  return opened;
}

}  // namespace

class EglContext final : public GlContext {
 public:
  explicit EglContext(const Opened& opened) : opened_(opened) {}
  ~EglContext() override {
    if (!InFork()) egl().DestroyContext(opened_.display, opened_.context);
  }

  GlBackend backend() const override { return GlBackend::kEgl; }
  void* Function(const char* name) const override { return egl().GetProcAddress(name); }

  // Throws IoError if the context cannot be used.
  void Probe() {
    Current scope(*this);
    using GetString = const char*(Enum);
    auto* get = reinterpret_cast<GetString*>(Function("glGetString"));
    const char* renderer = get ? get(kRendererName) : nullptr;
    const char* version = get ? get(kVersionName) : nullptr;
    if (!renderer || !version) throw IoError("the context reports no OpenGL version");
    description_ = std::string("egl: ") + renderer + ", OpenGL " + version;
  }

 private:
  void Enter(Saved& saved) override {
    Egl& e = egl();
    saved[3] = reinterpret_cast<void*>(static_cast<std::uintptr_t>(e.QueryAPI()));
    e.BindAPI(kOpenGlApi);
    saved[0] = e.GetCurrentContext();
    if (saved[0] == opened_.context) return;
    saved[1] = e.GetCurrentSurface(kDraw);
    saved[2] = e.GetCurrentSurface(kRead);
    saved_display_ = e.GetCurrentDisplay();
    if (!e.MakeCurrent(opened_.display, nullptr, nullptr, opened_.context)) {
      throw Error(ErrorText("eglMakeCurrent") +
                  ". An OpenGL context can be used by one thread at a time; if a window is open on "
                  "this thread, "
                  "render from another one.");
    }
  }

  void Leave(Saved& saved) noexcept override {
    Egl& e = egl();
    if (saved[0] != opened_.context) {
      if (saved[0]) {
        e.MakeCurrent(saved_display_, saved[1], saved[2], saved[0]);
      } else {
        e.MakeCurrent(opened_.display, nullptr, nullptr, nullptr);
      }
    }
    e.BindAPI(static_cast<Enum>(reinterpret_cast<std::uintptr_t>(saved[3])));
  }

  Opened opened_;
  Display saved_display_ = nullptr;
};

std::unique_ptr<GlContext> CreateEglContext() {
  static std::mutex mutex;  // eglInitialize of one display from two threads is not safe everywhere
  const std::lock_guard lock(mutex);
  std::string reasons;
  std::unique_ptr<EglContext> best;
  for (const Candidate& candidate : Candidates()) {
    if (best && !candidate.may_be_hardware) break;
    try {
      auto context = std::make_unique<EglContext>(Open(candidate.display));
      context->Probe();
      const bool done = !candidate.may_be_hardware || !IsSoftwareRenderer(context->description());
      if (done || !best) best = std::move(context);
      if (done) break;
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : "; ") + candidate.name + ": " + error.what();
    }
  }
  if (!best) throw IoError(reasons.empty() ? "no EGL device" : reasons);
  egl().library.MakeGlobal();
  return best;
}

}  // namespace robocell::internal
