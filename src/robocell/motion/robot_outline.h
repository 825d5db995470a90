// RobotOutline: the space that a robot takes up in its present posture, as upright boxes around its
// geoms. It proposes where the robot's base could stand; clearance.h checks exactly afterwards.
//
//   const RobotOutline outline(robot);
//   if (outline.IsClearOf(table_top, base_in_world, 0.01)) ...
#pragma once

#include <vector>
#include <Eigen/Geometry>

#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"

namespace robocell {

// A fixed level box, such as a table top: the centre of its upper face, z up, half extents along
// its x and y, and its depth. Metres.
struct LevelBox {
  Pose frame_to_world;
  double half_x = 0, half_y = 0;
  double thickness = 0;
};

class RobotOutline {
 public:
  // The outline is in the frame of the robot's base group; its poses must be up to date.
  explicit RobotOutline(const Robot& robot);

  // Returns true if no part of the robot is nearer to the obstacle than the margin (metres), for an
  // upright pose of the base.
  bool IsClearOf(const LevelBox& obstacle, const Pose& base_in_world, double margin) const;

 private:
  std::vector<Eigen::AlignedBox3d> boxes_;
};

}  // namespace robocell
