#include "robocell/render/renderer_backends.h"

#include <cstdlib>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/render/egl_devices.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_renderer.h"
#include "robocell/render/soft_renderer.h"

namespace robocell {
namespace {

constexpr const char* kVariable = "ROBOCELL_RENDERER";
constexpr const char* kAuto = "auto";

template <class T>
std::unique_ptr<Renderer> Make(const RendererOptions& options) {
  return std::make_unique<T>(options);
}

constexpr internal::RendererBackend kBackends[] = {
    {"gl", "MuJoCo's own drawing with OpenGL, on a graphics card where there is one.",
     &Make<internal::GlRenderer>},
    {"soft", "Drawing on the processor; needs no graphics library.", &Make<internal::SoftRenderer>},
};

std::unique_ptr<Renderer> MakeByName(const std::string& place, const std::string& name,
                                     const RendererOptions& options) {
  for (const internal::RendererBackend& backend : kBackends) {
    if (name == backend.name) return backend.make(options);
  }
  if (name == "filament") {
    throw NotFoundError(
        place +
        ": the back end 'filament', MuJoCo's physically based renderer, is not offered: in MuJoCo "
        "4.0 the same state gives other bytes in each image. 'soft' and 'gl' draw shadows and "
        "reflections with `quality: high`");
  }
  std::vector<std::string> known = RendererBackends();
  known.insert(known.begin(), kAuto);
  throw NotFoundError(NoSuchName(place, "back end", name, known));
}

// Returns the back end that the environment names, or "" if it leaves the choice to robocell.
std::string NameInEnvironment() {
  const char* name = std::getenv(kVariable);
  return name && std::string(name) != kAuto ? name : "";
}

// Returns true if the OpenGL was chosen explicitly.
bool GlIsChosen(const RendererOptions& options) {
  const EglDeviceChoice device = EglDeviceChoice::FromEnvironment();
  return GlBackendFromName(options.gl, "renderer") != GlBackend::kAuto ||
         GlBackendFromEnvironment() != GlBackend::kAuto || !device.robocell_device.empty() ||
         !device.mujoco_device.empty();
}

}  // namespace

namespace internal {

std::span<const RendererBackend> RendererBackendList() { return kBackends; }

}  // namespace internal

std::vector<std::string> RendererBackends() {
  std::vector<std::string> names;
  for (const internal::RendererBackend& backend : kBackends) names.emplace_back(backend.name);
  return names;
}

std::unique_ptr<Renderer> MakeRenderer(const RendererOptions& options) {
  if (options.backend != kAuto) return MakeByName("renderer", options.backend, options);
  if (const std::string name = NameInEnvironment(); !name.empty()) {
    return MakeByName(std::string("environment variable ") + kVariable, name, options);
  }
  // A fork of a process that has drawn would draw differently from that process.
  const bool fixed = GlIsChosen(options) || GlContext::InFork();
  try {
    return MakeByName("renderer", "gl", options);
  } catch (const Error&) {
    if (fixed) throw;
    return MakeByName("renderer", "soft", options);
  }
}

namespace internal {

std::string RendererBackendHere() {
  const std::string description = MakeRenderer()->description();
  for (const RendererBackend& backend : kBackends) {
    if (description.starts_with(std::string(backend.name) + ":")) return backend.name;
  }
  throw Error("the renderer '" + description + "' has no name");
}

}  // namespace internal

}  // namespace robocell
