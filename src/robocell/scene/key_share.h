// Private to scene. What of a keyframe belongs to one robot, where several robots stand in one
// model (RobotSpec::part_of) and share its keyframes.
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Per number of a keyframe: whether it is the robot's. Empty lists stand for all numbers.
struct KeyShare {
  std::vector<bool> qpos = {}, qvel = {}, act = {}, ctrl = {}, mocap = {};
};

// The part in whose model a robot is: itself, unless it says part_of. Objects are their own.
std::string HostOfPart(const CompiledScene& compiled, const std::string& part);

// A joint belongs to the robot that lists it in a move group; others to the robot of the next joint
// or root body above them, or to the host. Actuators go with what they move. Everything belongs to
// a part that shares its model with none.
KeyShare ShareOfKeys(const CompiledScene& compiled, const std::string& part);

}  // namespace robocell::internal
