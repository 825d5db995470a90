// Private to scene: checks that the joints can take the pose `home`, both of a robot's file and of
// the keyframes in the parts' own models.
#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part.h"

namespace robocell::internal {

// Tolerance for values from files beyond their limits, because files round.
inline constexpr double kLimitSlack = 1e-4;

// Returns "2 is outside the limits -1 to 1 of joint 'elbow'", with a hint at degrees that were
// meant as radians; unset for a value inside, for joints without limits, and for free and ball
// joints. `shown` is the joint's name in the message.
std::optional<std::string> OutsideLimits(const mjModel* model, int joint, double value,
                                         const std::string& shown);

// Reports the keyframe values that are outside the limits: as a problem where a reset would use
// them (of `home`, unless a robot's file replaces them), as a warning in other keyframes. A group
// of a robot without any home begins at the model's reference positions; a warning names those that
// are outside the limits, with a home to write.
void ValidateKeyframes(const mjModel* model, const PartKeys& parts,
                       const std::vector<RobotRecord>& robots, CompileLog& log);

}  // namespace robocell::internal
