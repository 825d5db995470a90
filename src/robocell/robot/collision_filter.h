// CollisionFilter: which configurations of an arm touch nothing, for IkOptions::filter and for
// whoever has configurations to judge.
//
//   IkResult found = robot.Ik(target, {.filter = CollisionFilter(robot, {.clearance = 0.01})});
//
// Judged by the engine's collision detection in a copy of the scene's state as it was when the
// filter was made, or at the last Update(): the arm is put to each configuration, everything else
// stays where it is, also what a gripper holds. Geoms that may collide in the model count
// (Robot::collision_geom_ids of the robot's); where the robot touches itself in the present state,
// it may do so everywhere. Copies share their state. Several threads may ask: one waits for the
// other (Update reads the scene, so the scene has to rest meanwhile). Error after objects were
// added to the scene or removed.
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
  // To everything that is not the robot, metres: 0 or more.
  double clearance = 0;
  // Bodies that may be touched, with all that hangs on them, by full name.
  std::vector<std::string> ignored{};
};

class CollisionFilter {
 public:
  // ArgumentError for a clearance below 0; NotFoundError for an unknown body.
  explicit CollisionFilter(const Robot& robot, const CollisionFilterOptions& options = {});

  // Takes over the scene's present state.
  void Update();
  // Joint values in chain order.
  bool IsFree(std::span<const double> q);
  // As IkFilter: `count` configurations row by row.
  void operator()(std::span<const double> q, int count, std::span<uint8_t> keep);
  int n_joints() const;
  // For garbage collectors of other languages: its scene, unless copies of this filter share it.
  std::optional<Scene> scene_of_sole_handle() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace robocell
