// Private to scene: the scene's keyframe `home`: where everything is after a reset.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part.h"

namespace robocell {

// An empty key `home`, before compiling, so that the model has room for it.
mjsKey* AddHomeKey(mjSpec* spec);

// Fills the key in model and spec. Joint positions: the model's reference, then the parts' own
// `home` (full names), then each robot's configured home. Controls: what holds these positions, for
// actuators whose force is gain * ctrl + a + b * length with b < 0 (servos, grippers too); a part's
// own control where its own positions apply; a gripper that says nothing about home is open.
void FillHomeKey(mjModel* model, mjsKey* key, const PartHome& parts,
                 const std::vector<RobotRecord>& robots);

}  // namespace robocell
