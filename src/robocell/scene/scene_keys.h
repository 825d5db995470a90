// Private to scene: the scene's keyframes. Number 0 is `home`, the state after a reset; it is
// followed by the other keyframes of the parts, each with its part's prefix, in which all other
// parts are at home.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part_keys.h"

namespace robocell::internal {

// Adds empty keyframes `home` and of these names before compiling, so that the model has space for
// them.
std::vector<mjsKey*> AddSceneKeys(mjSpec* spec, const std::vector<std::string>& presets);

// Fills the keyframes in model and spec. `keys` are those that AddSceneKeys returned for
// parts.presets; parts have full names.
//
// Positions and velocities of `home`: the model's reference, then the parts' own `home`, then each
// robot's configured home, at rest. Those of a preset: home's, then its own.
//
// Controls and activations are those that hold the positions, for every actuator that can hold
// (hold_ctrl.h). The part's own control is kept where it applies and
// - its actuator cannot hold a position: motors, velocity servos, muscles;
// - its actuator belongs to a gripper group, whose control is a closing force;
// - it rests nearby (kKeySlack), or pushes against the weight: by no more than twice the weight.
// A warning names the other controls, which are replaced, and the positions that no control holds.
// A gripper without a home is open there.
void FillSceneKeys(mjModel* model, const std::vector<mjsKey*>& keys, const PartKeys& parts,
                   const std::vector<RobotRecord>& robots, CompileLog& log);

}  // namespace robocell::internal
