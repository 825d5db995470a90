// Texts that identify geometry, as keys of what is computed from it once: bytes of numbers, the same
// wherever the bodies are.
#pragma once

#include <span>
#include <string>

#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Rounds to 0.1 micrometres, so that a relative pose is the same to the bit wherever both bodies are.
Pose RoundedPose(const Pose& pose);

void AppendNumbers(std::span<const double> numbers, std::string* text);
void AppendPose(const Pose& pose, std::string* text);
// Appends kind, sizes and vertices of a geom, in its own frame.
void AppendGeomShape(const mjModel* model, int geom, std::string* text);

}  // namespace robocell::internal
