// ScratchRobot: a copy of a scene's state in which a robot can be placed anywhere to find its
// contacts. The simulation itself is only read.
//
//   ScratchRobot scratch(robot, 0.01, "begin planning again");
//   scratch.SetArm(q);
//   const bool all_found = scratch.FindTouches();
//   for (const ScratchRobot::Touch& touch : scratch.touches()) ...
//
// Only the robot and its held object move in it; everything else stays as of the last Update().
// After objects were added to the scene or removed, it throws Error: make a new one. Use it from
// one thread at a time; it has its own data, so that scenes on other threads are not disturbed. No
// allocation once the vectors have grown.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

// Returns true if the engine looks for contacts of two geoms (its filters of mj_collision).
bool MayCollide(const mjModel* model, int a, int b);

class ScratchRobot {
 public:
  // Finds contacts nearer than `horizon` metres. `remedy` ends the message of the Error after
  // objects were added to the scene or removed.
  ScratchRobot(const Robot& robot, double horizon, std::string_view remedy);
  ~ScratchRobot();

  // Copies the scene's present state. Pairs of the robot's own geoms that touch in it are ignored
  // from then on.
  void Update();
  // Sets joint values of the arm's chain. FindTouches() updates the poses.
  void SetArm(std::span<const double> q);
  // Positions of the whole model, for other joints.
  std::span<double> qpos();
  // Makes the geoms of this body's subtree count as the robot's, and lets them touch it: the held
  // object, until the next Update(). The caller sets its position in qpos(). -1 for nothing.
  void Hold(int body);

  // A part of the robot that counts (Robot::collision_geom_ids) near another geom.
  struct Touch {
    int own_geom = -1, other_geom = -1;
    double distance = 0;  // m, below 0 when they overlap
    bool itself = false;  // the other geom belongs to the robot too
  };
  // Returns false if the engine lacks memory for all contacts, so that some are missing.
  bool FindTouches();
  // Returns those of the last FindTouches(). The robot touches itself only if the distance is below
  // 0.
  const std::vector<Touch>& touches() const;

  const Robot& robot() const;
  const mjModel* model() const;
  const mjData* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell::internal
