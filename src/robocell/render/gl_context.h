// Off-screen OpenGL contexts for MuJoCo's renderer: EGL (a GPU, or Mesa's software renderer), then
// OSMesa. No window, no display server. The libraries are loaded at first use, so that robocell
// runs without them.
//
// The back end is that of `GlBackend`; kAuto uses the environment variable ROBOCELL_GL (egl,
// osmesa, auto), then MUJOCO_GL if it is egl or osmesa, and else tries EGL, then OSMesa. EGL takes
// a graphics card if there is one, in any order of EGL's list. With several cards,
// MUJOCO_EGL_DEVICE_ID or ROBOCELL_EGL_DEVICE chooses one (egl_devices.h).
//
//   std::unique_ptr<GlContext> context = GlContext::Create();
//   {
//     GlContext::Current scope(*context);   // current on this thread until the end of the scope
//     ... OpenGL ...
//   }
//
// MuJoCo looks its GL functions up once per process, in the library of the first context. Therefore
// one process can use EGL or OSMesa, not both; a later request for the other one throws an Error
// that explains it.
//
// Throws Error with everything that was tried, why it failed and what to install. Threads: a
// context is current on one thread at a time; within that rule it may move between threads. The
// context that was current before a scope is current again after it. Processes: a fork of a process
// that has drawn lacks OpenGL's threads, and would wait for them for ever; making or using a
// context there is an Error.
//
// A destroyed context loses its compiled programs, 0.15 s of work in software. `GiveBack` keeps one
// for the next `Create`.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "robocell/render/egl_devices.h"

namespace robocell {

enum class GlBackend { kAuto, kEgl, kOsmesa };

// Returns "auto", "egl" or "osmesa".
const char* GlBackendName(GlBackend backend);
// Throws NotFoundError with suggestions for any other name; case does not matter.
GlBackend GlBackendFromName(std::string_view name, std::string_view place);
// Returns the meaning of kAuto in this process's environment; kAuto if the environment chooses
// nothing.
GlBackend GlBackendFromEnvironment();

class GlContext {
 public:
  // Returns a context that was given back, else a new one.
  static std::unique_ptr<GlContext> Create(GlBackend backend = GlBackend::kAuto);
  // Keeps it for the next caller that requests the same kind. All objects made in it must have been
  // freed, and no thread may use it.
  static void GiveBack(std::unique_ptr<GlContext> context) noexcept;

  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  virtual GlBackend backend() const = 0;
  // Returns a description of the renderer, for records: "egl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5
  // Mesa 22.3.6".
  const std::string& description() const { return description_; }
  // Returns a function of OpenGL by its name; null if the driver lacks it.
  virtual void* Function(const char* name) const = 0;

  // Makes a context current on this thread for a scope.
  class Current {
   public:
    explicit Current(GlContext& context) : context_(context) {
      RequireOwnProcess();
      context_.Enter(saved_);
    }
    ~Current() { context_.Leave(saved_); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    GlContext& context_;
    void* saved_[4] = {};  // the previous context, for the back end
  };

  // Returns true if this process is a fork of a process that has had a context.
  static bool InFork();

 protected:
  GlContext() = default;
  using Saved = void* [4];
  virtual void Enter(Saved& saved) = 0;
  virtual void Leave(Saved& saved) noexcept = 0;

  std::string description_;

 private:
  static void RequireOwnProcess();
  // Returns null if there is none.
  static std::unique_ptr<GlContext> TakeSpare(GlBackend backend, const EglDeviceChoice& device);

  EglDeviceChoice made_for_;  // the choice of its device
};

// Describes the renderer on this machine. Throws the errors of Create if there is none.
std::string DescribeGl(GlBackend backend = GlBackend::kAuto);

}  // namespace robocell
