// RobotOutline: how much room a robot takes in its present posture, as upright boxes around its
// geoms. For proposing where its base could stand; whether it can stand there is asked exactly
// afterwards (clearance.h).
//
//   const RobotOutline outline(robot);
//   if (outline.IsClearOf(support, base_in_world, 0.01)) ...
#pragma once

#include <vector>
#include <Eigen/Geometry>

#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"
#include "robocell/task/support.h"

namespace robocell {

class RobotOutline {
 public:
  // In the frame of the robot's base group; its poses must be up to date.
  explicit RobotOutline(const Robot& robot);

  // Whether no box is nearer to the support's body than the margin (metres), with the base at an
  // upright pose.
  bool IsClearOf(const Support& support, const Pose& base_in_world, double margin) const;

 private:
  std::vector<Eigen::AlignedBox3d> boxes_;
};

}  // namespace robocell
