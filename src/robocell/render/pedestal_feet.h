// Extends pedestals in pictures down to the surface below: tasks put robots at heights of their
// own, and the box under the robot has a fixed height. Physics is not affected.
//
//   const PedestalFeet feet(model);
//   mjv_updateScene(...);
//   feet.ReachDown(model, data, option, scene);   // after every update
//
// No allocation after the constructor, any thread.
#pragma once

#include <mujoco/mujoco.h>

#include <vector>

namespace robocell::internal {

class PedestalFeet {
 public:
  PedestalFeet() = default;
  // Finds the geoms `<prefix>pedestal` of bodies `<prefix><kind>_base` (scene/robot_base.h).
  explicit PedestalFeet(const mjModel* model);

  // Extends upright pedestals down to the nearest visible geom; without one they stay as they are.
  // `data` must have up-to-date poses.
  void ReachDown(const mjModel* model, const mjData* data, const mjvOption& option,
                 mjvScene* scene) const;

 private:
  std::vector<int> pedestals_;  // geoms
};

}  // namespace robocell::internal
