// The distance of a robot to everything else. A mocap base makes no contacts with static geoms, so
// placing a robot uses distances instead (mj_geomDistance).
#pragma once

#include <string>

#include "robocell/mujoco/forward.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

struct Clearance {
  // metres; at most the requested horizon; negative for an overlap
  double distance = 0;
  std::string robot_geom;  // "" if nothing is nearer than the horizon
  std::string other_geom;
};

inline constexpr double kMostFloorStep = 0.02;  // metres; lower steps are part of the floor

// What a robot may touch because it stands on it: the pedestal of a teleported base, planes; the base
// of a planar one, below its arm, also fixed geoms that end at its plane. Poses are up to date.
class FloorContact {
 public:
  explicit FloorContact(const Robot& robot);
  bool StandsOnFloors(int robot_geom) const;
  bool IsFloor(int geom) const;

 private:
  const mjModel* model_;
  const mjData* data_;
  bool is_planar_;
  int arm_ = -1;  // the body that the arm's first joint moves
  double plane_;  // height of the base's origin, metres
};

// Computes the clearance of all colliding geoms that represent the robot
// (Robot::collision_geom_ids) from all colliding geoms that are not the robot's. Poses must be up
// to date. What the robot stands on (FloorContact) does not count.
Clearance RobotClearance(const Scene& scene, const Robot& robot, double horizon);

}  // namespace robocell::internal
