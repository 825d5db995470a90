// ScratchRobot: a copy of a scene's state in which a robot can be put anywhere to see what it would
// touch. The simulation itself is only read.
//
//   ScratchRobot scratch(robot, 0.01, "begin planning again");
//   scratch.SetArm(q);
//   const bool all_found = scratch.FindTouches();
//   for (const ScratchRobot::Touch& touch : scratch.touches()) ...
//
// Only the robot moves in it, and what it holds; everything else stays where it was at the last Update(). After
// objects were added to the scene or removed make a new one: an Error says so. One thread at a
// time; its own data, so that scenes on other threads are not disturbed. No allocation once the
// vectors have grown.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell::internal {

class ScratchRobot {
 public:
  // Finds contacts nearer than `horizon` metres. `remedy` ends the message after objects were added
  // to the scene or removed.
  ScratchRobot(const Robot& robot, double horizon, std::string_view remedy);
  ~ScratchRobot();

  // Takes over the scene's present state. What of the robot touches itself in it is overlooked from
  // then on.
  void Update();
  // Joint values of the arm's chain. Poses follow in FindTouches().
  void SetArm(std::span<const double> q);
  // Positions of the whole model, for other joints.
  std::span<double> qpos();
  // From now on the geoms of this body's subtree count as the robot's and may touch it: what it
  // holds, until the next Update(). Where that is the caller says in qpos(). -1 for nothing.
  void Hold(int body);

  // Something of the robot that counts (Robot::collision_geom_ids) near something.
  struct Touch {
    int own_geom = -1, other_geom = -1;
    double distance = 0;  // m, below 0 when they overlap
    bool itself = false;  // the other is the robot's too
  };
  // False when the engine has no room for all contacts, so that some are missing.
  bool FindTouches();
  // Those of the last FindTouches(). The robot touches itself only where the distance is below 0.
  const std::vector<Touch>& touches() const;

  const Robot& robot() const;
  const mjModel* model() const;
  const mjData* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell::internal
