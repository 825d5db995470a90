// Grasps of an object that a robot can reach from where it stands now, without touching anything
// else: at the contact and on the straight way to it.
//
//   const GraspSet grasps = GraspsOf(robot, "mug");
//   const ReachReport reach = FindReachableGrasps(robot, grasps, {.most = 3});
//   if (reach.found.empty()) throw Error("the mug: " + reach.Reasons());
//   for (const ReachableGrasp& grasp : reach.found) Use(grasp.way);
//   MotionResult path = planner.Plan(GoalsBefore(robot.scene(), grasps));   // to any of them
//
// Cheap tests come first: the hand alone against the surroundings, then inverse kinematics of
// many at once, then the whole robot. Throws NotFoundError for a body that the scene does not have,
// ArgumentError for options out of range and for grasps of another robot's hand or without a
// direction, and Error after objects were added to the scene or removed meanwhile. Threads: those of
// the scene.
#pragma once

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/motion_goal.h"
#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"

namespace robocell {

// Lower is better. A grasp costs the sum of these.
struct GraspCosts {
  double score = 1;       // for a score of 0; nothing for 1
  double turn = 0.05;     // per rad between the present TCP and the grasp
  double distance = 0.1;  // per m between them
  double level = 0.1;     // for a level approach; nothing from above, twice as much from below
};

struct ReachOptions {
  int most = 1;          // stops after so many are found; at least 1
  int tried = 200;       // solved at most, in the order of their cost; at least 1
  double clearance = 0;  // m between the robot and everything but the object
  double lift = 0;       // m that the robot must be able to move up with the object; 0: none
  GraspCosts costs = {};
};

struct ReachableGrasp {
  Grasp grasp;
  int index = -1;     // in the set
  Pose tcp_in_world;  // at contact
  JointPath way;      // joint positions of the arm: the begin of the approach ... contact
  JointPath up;       // contact ... lifted; empty without lift
  double cost = 0;
};

struct ReachReport {
  std::vector<ReachableGrasp> found;  // by increasing cost
  int hand_in_collision = 0, out_of_reach = 0, way_out_of_reach = 0, in_collision = 0;
  // Returns "12 with the hand in collision, 48 out of reach" for messages; "no grasps" without any.
  std::string Reasons() const;
};

ReachReport FindReachableGrasps(const Robot& robot, const GraspSet& grasps,
                                const ReachOptions& options = {});

// Returns goals for a MotionPlanner: the TCP where the approach of each grasp begins, best first,
// for the object's present pose.
std::vector<MotionGoal> GoalsBefore(const Scene& scene, const GraspSet& grasps, int most = 32);

}  // namespace robocell
