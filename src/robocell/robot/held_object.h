// Private to robot: what a robot's grippers hold, for bases that are put elsewhere without it.
#pragma once

#include <string>

#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell {

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

}  // namespace robocell
