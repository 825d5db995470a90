// Private to scene: what is wrong in a part's own model file and would get lost when the part is
// put into a scene: the engine drops what refers to nothing, and keyframes are read by name.
#pragma once

#include "robocell/scene/part.h"
#include "robocell/scene/report.h"

namespace robocell {

// A problem when the file of a robot or tool is no MJCF but a URDF, which has no actuators, sites
// or cameras.
void CheckIsMjcf(const std::string& file, const std::string& place, const std::string& field,
                 Report& report);

// A problem for each actuator whose joint, tendon, site or body is not in the model.
void CheckActuatorTargets(const Part& part, Report& report);

// A problem when the keyframe `home` has not the numbers that the model needs.
void CheckHomeKeyLength(const Part& part, Report& report);

}  // namespace robocell
