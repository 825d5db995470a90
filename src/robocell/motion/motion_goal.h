// Goals of a motion: joint positions, or a TCP pose with as much freedom as the task leaves.
//
//   MotionGoal::Joints(q);
//   MotionGoal::Tcp(pose_in_world);
//   MotionGoal grasp = MotionGoal::Tcp(above_the_bottle);
//   grasp.free_rotation = {0, 0, M_PI};      // any turn about the goal's own z axis
//   grasp.position_box = {0.02, 0.02, 0};    // within 2 cm in its x and y
//
// A planner takes a list of goals and reaches one of them: give it every grasp that will do.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell {

struct MotionGoal {
  static MotionGoal Joints(std::vector<double> q) { return {.joints = std::move(q)}; }
  static MotionGoal Tcp(const Pose& tcp_in_world) { return {.tcp = tcp_in_world}; }

  // Joint positions of all planned joints, rad or m. If set, the fields below do not count.
  std::vector<double> joints{};
  // The pose of the arm's TCP in the world, the centre of the region below. Joints that do not move
  // this TCP keep their start positions.
  Pose tcp{};
  // Largest displacement along each axis of `tcp`, m, and rotation about each (roll, pitch, yaw), to
  // both sides, rad; pi: any.
  std::array<double, 3> position_box = {0, 0, 0}, free_rotation = {0, 0, 0};
  // The arm group; empty for the first of the planned ones.
  std::string arm{};
};

}  // namespace robocell
