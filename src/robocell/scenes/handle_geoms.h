// Handles of doors, drawers, lids and vessels: geoms whose names contain "handle" or "knob". A geom's
// own name counts, the one in its object's model: an object that is named door_handle_rig has no
// more handles than the same object under another name.
//
//   for (int geom = 0; geom < model->ngeom; ++geom) if (IsHandleGeom(scene, geom)) ...
//
// Threads: those of the scene.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Returns the name that an element of a body has in the model of the object that the body belongs
// to: "door" for "cabinet_door". Returns the full name for bodies that belong to no object.
std::string NameInObject(const Scene& scene, int body, const std::string& full_name);

// `geom`: its id in the scene's model. Geoms without a name are no handles.
bool IsHandleGeom(const Scene& scene, int geom);

}  // namespace robocell::internal
