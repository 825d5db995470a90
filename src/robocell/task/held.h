// Determines who holds an object from the contacts of a scene's present state.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// The kinds of bodies that touch a body's subtree in the present contacts.
struct Touching {
  bool robot = false;
  bool other = false;
};
Touching TouchingBody(const Scene& scene, const std::string& body);
// Returns true if robots touch it and nothing else does.
bool OnlyRobotsTouch(const Scene& scene, const std::string& body);
// Returns true if robots hold the object: nothing else touches it, and either a gripper has it
// between its fingers (GripperGroup::is_grasping) or several robots have it between them. A robot
// without a gripper holds what it touches, be it with a hook or a suction cup. An object that hangs
// on one finger is not held.
bool IsHeld(const Scene& scene, const std::string& body);
// Returns the sum of the normal forces between a body's subtree and all that is no robot, N.
double ForceOnOthers(const Scene& scene, int body);

}  // namespace robocell::internal
