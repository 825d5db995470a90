// The back ends of renderer.h by name: "gl" (MuJoCo's own drawing with OpenGL) and "soft" (vector
// instructions of the processor, no graphics library).
//
//   std::unique_ptr<Renderer> renderer = MakeRenderer({.backend = "soft"});
//   for (const RendererBackend& backend : RendererBackendList()) fmt::print("{}\n", backend.name);
//
// "auto", the default, is the back end in the environment variable ROBOCELL_RENDERER. Without it,
// it is "gl", or "soft" on machines without OpenGL. An OpenGL that was chosen explicitly
// (RendererOptions::gl, ROBOCELL_GL, MUJOCO_GL or a variable that chooses a device) is never
// replaced. Threads: any.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "robocell/render/renderer.h"

namespace robocell::internal {

struct RendererBackend {
  const char* name;
  const char* purpose;  // one sentence
  std::unique_ptr<Renderer> (*make)(const RendererOptions& options);
};

std::span<const RendererBackend> RendererBackendList();

// Returns the meaning of "auto" here. Throws the errors of MakeRenderer.
std::string RendererBackendHere();

}  // namespace robocell::internal
