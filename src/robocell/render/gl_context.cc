#include "robocell/render/gl_context.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/render/egl_devices.h"
#include "robocell/render/gl_backends.h"

namespace robocell {
namespace {

// The library of MuJoCo's GL functions in this process; kAuto until there is one.
std::atomic<GlBackend> process_backend = GlBackend::kAuto;

// The process that had the first context; 0 until there is one.
std::atomic<pid_t> drawing_process = 0;

// Unused contexts. Never destroyed: at the end of the process OpenGL may be unloaded first.
struct Spare {
  static constexpr size_t kMost = 2;
  std::mutex mutex;
  std::vector<std::unique_ptr<GlContext>> contexts;
};

Spare& spare() {
  static Spare* kept = new Spare;
  return *kept;
}

std::string Lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::unique_ptr<GlContext> CreateOne(GlBackend backend) {
  return backend == GlBackend::kEgl ? internal::CreateEglContext()
                                    : internal::CreateOsmesaContext();
}

const char* InstallHint(GlBackend backend) {
  return backend == GlBackend::kEgl ? "apt-get install libegl1 libgl1-mesa-dri"
                                    : "apt-get install libosmesa6";
}

std::vector<GlBackend> Order(GlBackend wanted) {
  const GlBackend fixed = process_backend;
  if (wanted == GlBackend::kAuto) wanted = GlBackendFromEnvironment();
  if (fixed != GlBackend::kAuto) {
    if (wanted != GlBackend::kAuto && wanted != fixed) {
      throw Error(std::string("rendering with ") + GlBackendName(wanted) +
                  ": this process already renders with " + GlBackendName(fixed) +
                  ", and MuJoCo can use only one OpenGL library per process. Start a new process "
                  "for the other one.");
    }
    return {fixed};
  }
  if (wanted != GlBackend::kAuto) return {wanted};
  return {GlBackend::kEgl, GlBackend::kOsmesa};
}

}  // namespace

const char* GlBackendName(GlBackend backend) {
  switch (backend) {
    case GlBackend::kEgl:
      return "egl";
    case GlBackend::kOsmesa:
      return "osmesa";
    case GlBackend::kAuto:
      break;
  }
  return "auto";
}

GlBackend GlBackendFromName(std::string_view name, std::string_view place) {
  for (GlBackend backend : {GlBackend::kAuto, GlBackend::kEgl, GlBackend::kOsmesa}) {
    if (Lower(name) == GlBackendName(backend)) return backend;
  }
  throw NotFoundError(NoSuchName(place, "GL back end", name, {"auto", "egl", "osmesa"}));
}

GlBackend GlBackendFromEnvironment() {
  const char* ours = std::getenv("ROBOCELL_GL");
  if (ours && *ours) return GlBackendFromName(ours, "environment variable ROBOCELL_GL");
  const char* theirs =
      std::getenv("MUJOCO_GL");  // other values (glfw, glx, off ...) have no meaning here
  if (theirs && Lower(theirs) == "egl") return GlBackend::kEgl;
  if (theirs && Lower(theirs) == "osmesa") return GlBackend::kOsmesa;
  return GlBackend::kAuto;
}

bool GlContext::InFork() {
  const pid_t first = drawing_process;
  return first != 0 && first != getpid();
}

void GlContext::RequireOwnProcess() {
  if (!InFork()) return;
  throw Error(
      "this process was forked after something had been drawn, and OpenGL does not work in such a "
      "fork. Start a new process: context='forkserver' or 'spawn' in multiprocessing and in "
      "Gymnasium's "
      "AsyncVectorEnv; or make copies of an environment in one process: gym.make_vec, "
      "robocell.gym.VectorGymEnv");
}

void GlContext::GiveBack(std::unique_ptr<GlContext> context) noexcept {
  if (!context || InFork()) return;
  Spare& kept = spare();
  const std::lock_guard lock(kept.mutex);
  if (kept.contexts.size() < Spare::kMost) kept.contexts.push_back(std::move(context));
}

std::unique_ptr<GlContext> GlContext::TakeSpare(GlBackend backend, const EglDeviceChoice& device) {
  Spare& kept = spare();
  const std::lock_guard lock(kept.mutex);
  const auto found = std::find_if(kept.contexts.begin(), kept.contexts.end(), [&](const auto& one) {
    return one->backend() == backend && one->made_for_ == device;
  });
  if (found == kept.contexts.end()) return nullptr;
  auto context = std::move(*found);
  kept.contexts.erase(found);
  return context;
}

std::unique_ptr<GlContext> GlContext::Create(GlBackend wanted) {
  RequireOwnProcess();
  const EglDeviceChoice device = EglDeviceChoice::FromEnvironment();
  std::string tried, install;
  for (GlBackend backend : Order(wanted)) {
    if (auto context = TakeSpare(backend, device)) return context;
    try {
      auto context = CreateOne(backend);
      context->made_for_ = device;
      process_backend = backend;
      drawing_process = getpid();
      return context;
    } catch (const ArgumentError&) {  // the caller requested a missing one: no silent replacement
      throw;
    } catch (const Error& error) {
      tried += std::string("\n  ") + GlBackendName(backend) + ": " + error.what();
      install += std::string(install.empty() ? "" : "  or  ") + InstallHint(backend);
    }
  }
  throw Error(
      "no OpenGL for off-screen rendering. Tried:" + tried +
      "\nInstall one of them (Debian, Ubuntu): " + install +
      "\nROBOCELL_GL=egl or ROBOCELL_GL=osmesa chooses one. ROBOCELL_RENDERER=soft draws without "
      "OpenGL.");
}

std::string DescribeGl(GlBackend backend) {
  auto context = GlContext::Create(backend);
  std::string description = context->description();
  GlContext::GiveBack(std::move(context));
  return description;
}

}  // namespace robocell
