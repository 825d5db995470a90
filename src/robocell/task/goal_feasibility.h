// Whether a goal can be met at all: an object can come to rest there, and a robot can bring it
// there. Both look for what no episode could do: a goal that passes may still be hard.
//
//   if (const std::string why = WhyNoRest(scene, "cube", at, 0.03); !why.empty()) ...
//       // "there it is 35 mm inside table"
#pragma once

#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// Where an object is to rest: a place in the frame of a body, whose body may give way.
struct RestPlace {
  int frame = 0;  // body id; 0, the world's, does not move
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

// "" when the root of a free object, a body, can come to rest within `tolerance` of one of the
// places; else what becomes of it at the first. It is put down at each place and beside it, upright
// as it is now, turned and lying, in a simulation of its own in which robots are no obstacles. The
// present state is where everything else is.
std::string WhyNoRest(const Scene& scene, int object, std::span<const RestPlace> places,
                      double tolerance);

// "" when one of the robots may get to within `slack` of a place in the world, or of a point straight
// below it down to the height `lowest`, metres; else how far the nearest of them is from it. The
// bound is that of the arms' links stretched out. Robots whose base can move get everywhere.
std::string WhyOutOfReach(const std::vector<Robot>& robots, const Eigen::Vector3d& place,
                          double lowest, double slack);

// How high a place in the world is above what is under it and collides, metres: negative inside of
// something, infinite above nothing. Robots and the subtree of the body `without` do not count.
double HeightOverSupport(const Scene& scene, const Eigen::Vector3d& place, int without);

// The farthest point of a body's geoms from the body's origin, metres; no less than the truth.
double RadiusOf(const mjModel* model, int body);

}  // namespace robocell::internal
