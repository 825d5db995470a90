// Turns goals into joint positions: inverse kinematics of many samples of each goal at once.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/motion/collision_model.h"
#include "robocell/motion/goal_trees.h"
#include "robocell/motion/motion_goal.h"
#include "robocell/motion/path_judge.h"
#include "robocell/robot/task_space.h"

namespace robocell::internal {

// An arm of the robot within the planned joints.
struct PlannedArm {
  std::string name;
  Chain chain;            // from a body that no planned joint moves to the TCP
  std::vector<int> dofs;  // of each joint of the chain: index in the configuration, -1 if it stays
  Pose base_in_world;     // of the chain's base, at the model's last Update()
  TaskSpace task_space;   // the part of its goals that counts
};

// Makes the arms that have a planned joint.
std::vector<PlannedArm> FindPlannedArms(const CollisionModel& model);
// Returns one of them by name, the first for "". Throws NotFoundError that lists them.
const PlannedArm& ArmNamed(const std::vector<PlannedArm>& arms, const std::string& name,
                           const std::string& place);
// Returns the values of the chain's joints, those that stay from the present state of the scene.
JointVector ChainValues(const PlannedArm& arm, const CollisionModel& model,
                        std::span<const double> q);

struct SolvedGoals {
  struct Solution {
    int goal = -1;
    std::vector<double> q;
  };
  std::vector<Solution> solutions{};  // by distance from the start
  std::string why_none{};             // the reason for the first goal without a solution
};

// Throws ArgumentError for a goal that does not fit the robot.
SolvedGoals SolveGoals(const CollisionModel& model, const std::vector<PlannedArm>& arms,
                       const JointSpace& space, const std::vector<Interval>& limits,
                       std::span<const double> start, std::span<const MotionGoal> goals, int most,
                       const std::string& place, Rng rng);

}  // namespace robocell::internal
