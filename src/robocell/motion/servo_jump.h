// How far the target of a servo may jump at once before the servo is at its force limit.
//
// Targets change once per policy tick. A stiff servo with a low limit answers a large jump with its
// limit, and with the opposite limit one engine step later: the hand shakes, and what it holds
// lightly slides out. A motion that must not do that is timed by this.
#pragma once

#include <vector>

#include "robocell/motion/joint_path.h"
#include "robocell/mujoco/forward.h"
#include "robocell/robot/move_group.h"

namespace robocell {

// Returns for each joint of an arm, in order, the jump in rad or m that takes its servo from rest
// to the force limit of actuator or joint. It is infinite without a limit, if it cannot be
// computed, and for an arm of other actuators.
std::vector<double> ServoJumps(const mjModel* model, const MoveGroup& arm);

// The least duration in seconds of a leg of a TimedPath (timed_path.h) through `points` in which no
// target jumps by more than `jumps`, with a target every `tick` seconds.
double SecondsForJumps(const JointPath& points, const std::vector<double>& jumps, double tick);

}  // namespace robocell
