// The OSMesa back end of gl_context.h. Internal to render/.
#pragma once

#include <memory>

#include "robocell/render/gl_context.h"

namespace robocell {

// Throws IoError with the reason.
std::unique_ptr<GlContext> CreateOsmesaContext();

}  // namespace robocell
