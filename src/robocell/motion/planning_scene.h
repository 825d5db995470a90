// PlanningScene: a scratch copy of a scene's state (scratch_robot.h) in which a robot with a
// gripper can be put anywhere to see whether it would touch what it should not.
//
//   PlanningScene planning(scene, robot, target_body, shape);
//   if (planning.IsFree(q, {.gap = shape->open_gap(), .clearance = 0.02})) ...
//
// Only the robot moves in it, and the target while it is held; objects stay where they were at the
// last Update(). After objects were
// added to the scene or removed make a new one: an Error says so. One thread at a time.
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

// How a configuration is judged.
struct FreedomDemand {
  double gap = 0;             // of the fingers, metres
  double clearance = 0;       // to everything that is not the robot, metres, at most kMostClearance
  bool touch_target = false;  // contacts with the target are fine
};
inline constexpr double kMostClearance = 0.025;

// Which bodies were in the way how often, for messages.
class InTheWay {
 public:
  // Bodies that met, a part of the robot first.
  void Add(const std::array<int, 2>& bodies) { ++counts_[bodies]; }
  // " (most often 'palm' with 'table')"; "" when nothing was.
  std::string Text(const mjModel* model) const;

 private:
  std::map<std::array<int, 2>, int> counts_;
};

class PlanningScene {
 public:
  PlanningScene(const Scene& scene, const Robot& robot, const std::string& target_body,
                std::shared_ptr<const GripperShape> shape);
  ~PlanningScene();

  // Takes over the scene's present state, in which nothing is held.
  void Update();
  // From now on the target moves with the TCP and must not come nearer than the clearance to what is
  // not the robot; it may touch the robot. The target has a free joint. Until Update() or
  // PutTarget().
  void HoldTarget(const Pose& target_in_tcp);
  // Puts the target somewhere, where it stays.
  void PutTarget(const Pose& target_in_world);
  // Nothing that is not the robot is nearer than the clearance, and no two parts of the robot touch
  // that do not touch in its present posture anyhow.
  bool IsFree(const JointVector& q, const FreedomDemand& demand);
  // The bodies that met when IsFree last said no, a part of the robot first.
  std::array<int, 2> in_the_way() const;
  // How often IsFree was asked.
  int checks() const;

  const Robot& robot() const;
  const GripperShape& shape() const;
  int target_body() const;
  // The state of the last Update(): nothing above changes what is not the robot.
  const mjModel* model() const;
  const mjData* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
