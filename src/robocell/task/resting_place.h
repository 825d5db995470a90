// Finds out whether an object can come to rest at a place at all. This only finds what no episode
// could do: a place that passes may still be a hard goal.
//
//   if (const std::string why = WhyNoRest(scene, "cube", at, 0.03); !why.empty()) ...
//       // "there it is 35 mm inside table"
#pragma once

#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/scene/scene.h"

namespace robocell::internal {

// A place at which an object is to rest, in the frame of a body, which may give way.
struct RestPlace {
  int frame = 0;  // body id; 0, the world's, does not move
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

// Returns "" if the root of a free object (a body) can come to rest within `tolerance` of one of
// the places, else what happens to it at the first one. The check puts the object down at and
// beside each place, upright as it is now, turned and lying, in a separate simulation in which
// robots and `ignored` bodies do not count as obstacles. All other objects are where they are in
// the present state.
std::string WhyNoRest(const Scene& scene, int object, std::span<const RestPlace> places,
                      double tolerance, std::span<const int> ignored = {});

// Returns the height in metres of a place in the world above the nearest collision geometry under
// it: negative inside something, infinite above nothing. Robots and the subtree of the body
// `without` do not count.
double HeightOverSupport(const Scene& scene, const Eigen::Vector3d& place, int without);

}  // namespace robocell::internal
