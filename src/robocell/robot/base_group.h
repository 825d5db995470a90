// The bases a robot can stand on: fixed, mocap (teleported), free (floating), planar and driven
// (follows a target).
#pragma once

#include <memory>

#include "robocell/robot/group_core.h"

namespace robocell {

// `names.leaf`: the body that pose() is the pose of. `names.joints`: those of a free, planar or
// driven base. ArgumentError when a planar base has other joints than x, y and yaw.
std::unique_ptr<BaseGroup> MakeBaseGroup(const Scene& scene, const RobotRecord& robot,
                                         GroupNames names);

}  // namespace robocell
