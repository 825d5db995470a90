// RobotOutline: the space that a robot takes up in its present posture, as upright boxes around its
// geoms. It proposes where the robot's base could stand; clearance.h checks exactly afterwards.
//
//   const RobotOutline outline(robot);
//   if (outline.IsClearOf(table_top, base_in_world, 0.01)) ...
#pragma once

#include <vector>
#include <Eigen/Geometry>

#include "robocell/math/level_area.h"
#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

class RobotOutline {
 public:
  // The outline is in the frame of the robot's base group; its poses must be up to date.
  explicit RobotOutline(const Robot& robot);

  // Returns true if no part of the robot is nearer to the obstacle, a box with this top, than the
  // margin (metres), for an upright pose of the base.
  bool IsClearOf(const LevelArea& obstacle, const Pose& base_in_world, double margin) const;

 private:
  std::vector<Eigen::AlignedBox3d> boxes_;
};

}  // namespace robocell::internal
