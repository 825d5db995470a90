// PlaceOverlap: tests whether an object would be inside of something else, were it put somewhere.
//
//   PlaceOverlap overlap(scene, body);
//   if (overlap.IsFree(pose)) ...   // of the body in the world
//
// Everything else is where it was at construction. Robots do not count: they move. Nor do parts that
// cannot collide with the object. Threads: those of the scene.
#pragma once

#include <utility>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class PlaceOverlap {
 public:
  // Requires up-to-date poses of the scene.
  PlaceOverlap(const Scene& scene, int body);

  static constexpr double kMostDeep = 0.001;  // m: what stands touches

  // Returns true if the body, with its subtree, keeps `gap` metres to everything; a negative one
  // allows it to be so deep in something.
  bool IsFree(const Pose& body_in_world, double gap = -kMostDeep);

 private:
  Scene scene_;
  DataPtr data_;
  std::vector<std::pair<int, Pose>> own_;  // geoms, in the frame of the body
  std::vector<int> others_;
};

}  // namespace robocell::internal
