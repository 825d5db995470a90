// The bases a robot can stand on: fixed, mocap (teleported), free (floating), planar and driven
// (follows a target). A base that is teleported leaves behind what the robot's grippers hold, and a
// warning says so.
#pragma once

#include <memory>
#include <string>

#include "robocell/robot/group_core.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

// `names.leaf`: the body that pose() is the pose of. `names.joints`: those of a free, planar or
// driven base. ArgumentError when a planar base has other joints than x, y and yaw.
std::unique_ptr<BaseGroup> MakeBaseGroup(const Scene& scene, const RobotRecord& robot,
                                         GroupNames names);

// "gripper 'hand' holds 'cube'", of the first gripper that holds something; "" for none and for a
// robot that nobody made a Robot of. By the contacts of the last step.
std::string HeldByRobot(const Scene& scene, const std::string& robot);

// Warns, once, that a base is teleported away from what the robot holds, and says how to carry it.
class LeavesObject {
 public:
  // `place` begins the message.
  void Warn(const Scene& scene, const std::string& robot, const std::string& place, BaseKind base);

 private:
  bool told_ = false;
};

}  // namespace robocell::internal
