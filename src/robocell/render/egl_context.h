// The EGL back end of gl_context.h. Internal to render/.
#pragma once

#include <memory>

#include "robocell/render/gl_context.h"

namespace robocell {

// Throws IoError with everything that was tried.
std::unique_ptr<GlContext> CreateEglContext();

}  // namespace robocell
