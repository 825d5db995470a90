// Poses of bodies by their names, in Python {name: Pose}.
#pragma once

#include "bindings.h"
#include "values.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// Converts any mapping. Raises TypeError "<path>.cube must be a Pose, got ..."; a PyKDL.Frame is
// accepted.
BodyPoses ToBodyPoses(nb::handle value, const FieldPath& path);
nb::dict ToDict(const BodyPoses& poses);

}  // namespace robocell::python
