// PlanningScene: a scratch copy of a scene's state (scratch_robot.h) in which a robot with a
// gripper can be placed anywhere to check for unwanted contacts.
//
//   PlanningScene planning(scene, robot, target_body, shape);
//   if (planning.IsFree(q, {.gap = shape->open_gap(), .clearance = 0.02})) ...
//
// Only the robot moves in it, and the target while it is held; objects stay as of the last
// Update(). After objects were added to the scene or removed, it throws Error: make a new one. One
// thread at a time.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell {

// The conditions of a collision-free configuration.
struct FreedomDemand {
  double gap = 0;             // finger gap, metres
  double clearance = 0;       // clearance to other bodies, metres, at most kMostClearance
  bool touch_target = false;  // allows contacts with the target
};
inline constexpr double kMostClearance = 0.025;

// Counts which bodies collided, for messages.
class ObstacleCounts {
 public:
  // Counts two colliding bodies, a part of the robot first.
  void Add(const std::array<int, 2>& bodies) { ++counts_[bodies]; }
  // Returns " (most often 'palm' with 'table')", or "" if nothing was counted.
  std::string Text(const mjModel* model) const;

 private:
  std::map<std::array<int, 2>, int> counts_;
};

class PlanningScene {
 public:
  PlanningScene(const Scene& scene, const Robot& robot, const std::string& target_body,
                std::shared_ptr<const GripperShape> shape);
  ~PlanningScene();

  // Copies the scene's present state, in which nothing is held.
  void Update();
  // Makes the target move with the TCP, until Update() or PutTarget(). It must keep the clearance
  // to everything but the robot, which it may touch. The target has a free joint.
  void HoldTarget(const Pose& target_in_tcp);
  // Puts the target at a pose, where it stays.
  void PutTarget(const Pose& target_in_world);
  // Returns true if nothing but the robot is nearer than the clearance, and no two parts of the
  // robot touch that do not touch in its present posture.
  bool IsFree(const JointVector& q, const FreedomDemand& demand);
  // Returns the bodies that collided when IsFree last returned false, a part of the robot first.
  std::array<int, 2> obstacle() const;
  // Returns the number of calls of IsFree.
  int checks() const;

  const Robot& robot() const;
  const GripperShape& shape() const;
  int target_body() const;
  // The state of the last Update(): the functions above only change the robot.
  const mjModel* model() const;
  const mjData* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
