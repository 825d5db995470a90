// Action: the commands of robots until the next policy tick: robot -> group -> command. A group
// without a command keeps its target and so holds still.
//
//   Action action;
//   action["xarm7"]["arm"] = GroupCommand::Joints({...});
//   action["xarm7"]["gripper"] = GroupCommand::Opening(1);
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell {

struct GroupCommand {
  enum Kind {
    kJoints,          // absolute joint positions, rad or m
    kRelativeJoints,  // added to the present target
    kPose,            // pose of the leaf frame in the robot base frame, through IK
    kOpening,         // gripper opening, 0 closed ... 1 open
    kVelocities,      // joint velocities, rad/s or m/s
    kTorques,         // joint torques, Nm or N
    kBasePose,        // pose of a driven base in the world
  };
  Kind kind = kJoints;
  std::vector<double> values = {};
  Pose pose = {};

  static GroupCommand Joints(std::vector<double> q) { return {kJoints, std::move(q), {}}; }
  static GroupCommand RelativeJoints(std::vector<double> dq) {
    return {kRelativeJoints, std::move(dq), {}};
  }
  static GroupCommand LeafPose(const Pose& leaf_in_robot) { return {kPose, {}, leaf_in_robot}; }
  static GroupCommand Opening(double opening) { return {kOpening, {opening}, {}}; }
  static GroupCommand Velocities(std::vector<double> v) { return {kVelocities, std::move(v), {}}; }
  static GroupCommand Torques(std::vector<double> t) { return {kTorques, std::move(t), {}}; }
  static GroupCommand BasePose(const Pose& base_in_world) { return {kBasePose, {}, base_in_world}; }
};

using RobotAction = std::map<std::string, GroupCommand>;
using Action = std::map<std::string, RobotAction>;

}  // namespace robocell
