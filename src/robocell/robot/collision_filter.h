// CollisionFilter: finds collision-free configurations of an arm, for IkOptions::filter and for
// code that has configurations to judge.
//
//   IkResult found = robot.Ik(target, {.filter = CollisionFilter(robot, {.clearance = 0.01})});
//
// It uses the engine's collision detection in a copy of the scene's state at construction, or at
// the last Update(): the arm is put to each configuration, everything else stays in place, also an
// object that a gripper holds. Geoms that may collide in the model count (for the robot, those of
// Robot::collision_geom_ids); pairs of the robot's own geoms that touch in the present state may
// touch everywhere. Copies share their state. Several threads may use it, one at a time (Update
// reads the scene, which must not change meanwhile). Throws Error after objects were added to the
// scene or removed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell {

struct CollisionFilterOptions {
  // Clearance to everything that is not the robot, metres: 0 or more.
  double clearance = 0;
  // Bodies that may be touched, with their subtrees, by full name.
  std::vector<std::string> ignored{};
};

class CollisionFilter {
 public:
  // Throws ArgumentError for a clearance below 0, NotFoundError for an unknown body.
  explicit CollisionFilter(const Robot& robot, const CollisionFilterOptions& options = {});

  // Copies the scene's present state.
  void Update();
  // Joint values are in chain order.
  bool IsFree(std::span<const double> q);
  // Implements IkFilter: `count` configurations row by row.
  void operator()(std::span<const double> q, int count, std::span<uint8_t> keep);
  int n_joints() const;
  // Returns its scene, unless copies of this filter share it; for garbage collectors of other
  // languages.
  std::optional<Scene> scene_of_sole_handle() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace robocell
