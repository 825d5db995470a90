// Which geoms are handles, by their names in their own models.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Returns true for names that contain "handle" or "knob", in any case.
bool IsHandleName(const std::string& name);

// Returns true for a geom with such a name. The name of the object that it belongs to does not
// count: the walls of an object 'knob_box' are no knobs.
bool IsHandleGeom(const Scene& scene, int geom);

}  // namespace robocell::internal
