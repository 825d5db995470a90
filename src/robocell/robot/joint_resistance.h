// Resistance of joints to motion: their springs, dampers and friction.
#pragma once

#include <span>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// Adds to `torque` (N m or N) what keeps joints at `q` moving at `velocity` (rad and rad/s, or m
// and m/s) against their springs, their dampers, those of actuators on them (which count even where
// the actuator is switched off) and their friction loss. For a joint at rest only the spring
// counts, and effects that the model's options switch off do not count. Joints of one degree of
// freedom; tendons are left out. No allocation.
//
// The polynomials are the engine's: springs exert x (k0 + k1 x + k2 x^2), dampers v (d0 + d1 |v| +
// d2 v^2), those of actuators with the joint's velocity and the gear squared. Friction is the
// engine's soft one: proportional to the velocity up to the loss.
void AddJointResistance(const mjModel* model, const std::vector<int>& joint_ids,
                        std::span<const double> q, std::span<const double> velocity,
                        std::span<double> torque);

}  // namespace robocell::internal
