// The distance of a robot to everything else. A mocap base makes no contacts with static geoms, so
// placing a robot uses distances instead (mj_geomDistance).
#pragma once

#include <string>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

struct Clearance {
  // metres; at most the requested horizon; negative for an overlap
  double distance = 0;
  std::string robot_geom;  // "" if nothing is nearer than the horizon
  std::string other_geom;
};

// Computes the clearance of all colliding geoms that represent the robot
// (Robot::collision_geom_ids) from all colliding geoms that are not the robot's. Poses must be up
// to date. Planes (floors) count for the arm but not for the pedestal, which may stand in them.
Clearance RobotClearance(const Scene& scene, const Robot& robot, double horizon);

}  // namespace robocell::internal
