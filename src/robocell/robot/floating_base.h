// Finds robots whose base floats and is held by nothing.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Simulates one second from `home` in data of its own, with the controls of `home`. Returns how the
// floating base of a robot falls or tips over by then, and what to do; "" if it stays within 5 cm
// and 20 degrees, and for bases of other kinds. Throws EngineError.
std::string WhyBaseFalls(const Scene& scene, const RobotRecord& robot);

}  // namespace robocell::internal
