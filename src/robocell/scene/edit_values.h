// Private to scene: the attributes and masses that an edit gives to elements of a model that is being
// written.
#pragma once

#include <optional>
#include <string>

#include "robocell/scene/compile_log.h"
#include "robocell/spec/edit.h"

struct mjsElement_;
typedef struct mjsElement_ mjsElement;
struct mjsBody_;
typedef struct mjsBody_ mjsBody;
struct mjsGeom_;
typedef struct mjsGeom_ mjsGeom;

namespace robocell {

// Each attribute is in the compiled model as the edit says, or it is a problem at `place`. The name
// is none of them.
void SetEdited(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log);

// The engine takes the mass of a body from its <inertial> or from its geoms, and says nothing of
// what it does not take: a number that is written where the other counts is lost. Both change the model so that the engine takes the mass, kg, or leave it and say why not and
// what to write instead.
//
// The inertia is scaled with the mass. Where it comes from geoms, these keep their shares of it.
std::optional<std::string> SetBodyMass(mjsBody* body, double mass);
std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass);

}  // namespace robocell
