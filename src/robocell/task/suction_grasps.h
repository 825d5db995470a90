// Where a suction gripper could stick to an object from above: places of its top, found with rays,
// that are flat and level over the whole face of the cup. Private to task; FindGrasps calls it.
#pragma once

#include <string>
#include <vector>

#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/forward.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell::internal {

// Returns the candidates, in no order; their width is 0. The cup ends slightly inside the object,
// so that it presses. Poses in `data` must be up to date.
std::vector<GraspCandidate> FindSuctionGrasps(const mjModel* model, const mjData* data,
                                              int object_body, const GripperShape& shape);

// Returns why an object has no candidate: "its top is not flat over the 0.04 m of the cup".
std::string WhyNothingSticks(const GripperShape& shape);

}  // namespace robocell::internal
