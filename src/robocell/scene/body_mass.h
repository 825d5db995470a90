// Private to scene: masses in a model that is being written. The engine takes the mass of a body
// from its <inertial> or from its geoms, and says nothing of what it does not take: a number that
// is written where the other counts is lost.
#pragma once

#include <optional>
#include <string>

struct mjsBody_;
typedef struct mjsBody_ mjsBody;
struct mjsGeom_;
typedef struct mjsGeom_ mjsGeom;

namespace robocell {

// Both change the model so that the engine takes the mass, kg, or leave it and say why not and
// what to write instead.

// The inertia is scaled with the mass. Where it comes from geoms, these keep their shares of it.
std::optional<std::string> SetBodyMass(mjsBody* body, double mass);
std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass);

}  // namespace robocell
