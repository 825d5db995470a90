// Where a robot that drives stands to work on an object: places of its base from which grasps of the
// object are in reach, and starts from which it drives there.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/motion/floor_map.h"
#include "robocell/robot/robot.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns true for robots whose planar base actuators drive.
bool DrivesItself(const RobotConfig& robot);
// Returns true for runs whose robots drive to their work: unless `start.base_distance` puts them
// beside it, their starts are all over the floor.
bool StartsAnywhere(const RunConfig& run);

// Returns the nearest and the farthest distance of the base from a target that its arm may reach,
// metres, for the height of the target; unset if it lies too high or too low for the arm.
std::optional<Vec2> DistancesInReach(const Robot& robot, const Eigen::Vector3d& target);

// A place of the base, and how many of the grasps that were asked for are in reach from there.
struct WorkStance {
  FloorPlace base;
  int grasps = 0;
};

// Returns places all around an object from which grasps of it are in reach, without regard to
// collisions of the arm, most grasps first; those that the robot is free at, in its present posture.
// They are found by inverse kinematics of grasps from many places at once.
std::vector<WorkStance> FindWorkStances(const Robot& robot, const std::string& body);

// Returns poses of the base anywhere on the floor of this height; none without such floor.
std::vector<Pose> DrawOnFloor(std::span<const FloorArea> floor, double height, int count, Rng& rng);

}  // namespace robocell::internal
