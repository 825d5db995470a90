// The bases of robots: fixed, mocap (teleported), free (floating), planar (by joints, or by wheels:
// wheeled_base.h) and driven (follows a target). A teleported base leaves behind objects that the robot's grippers hold, with a warning.
#pragma once

#include <memory>
#include <string>

#include "robocell/robot/group_core.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// `names.leaf`: the body whose pose is pose(). `names.joints`: those of a free, planar or driven
// base, the wheels of a wheeled one. Throws ArgumentError if a planar base has other joints than x, y
// and yaw, or wheels that cannot drive it.
std::unique_ptr<BaseGroup> MakeBaseGroup(const Scene& scene, const RobotRecord& robot,
                                         GroupNames names);

// Returns "gripper 'hand' holds 'cube'" for the first gripper that holds something; "" for none and
// for a robot without a Robot object. Based on the contacts of the last step.
std::string HeldByRobot(const Scene& scene, const std::string& robot);

// Warns, once, that a base is teleported away from the object that the robot holds, and explains
// how to carry it.
class LeavesObject {
 public:
  // `place` begins the message. The base moves from `from` to `to`, both in the world.
  void Warn(const Scene& scene, const std::string& robot, const std::string& place, BaseKind base,
            const Pose& from, const Pose& to);

 private:
  bool warned_ = false;
};

}  // namespace robocell::internal
