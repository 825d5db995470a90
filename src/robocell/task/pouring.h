// The relation `poured_into`: what was in one vessel is in another one. The grains of a vessel `cup`
// are the free objects `cup_grain`, or `cup_grain_0`, `cup_grain_1` etc.
//
//   | sentence                | holds if                                             |
//   | A poured_into B [share] | that share of the grains of A is in vessel B (0.8)   |
//
// Throws NotFoundError for unknown names and ArgumentError for a vessel without grains, and for one to
// pour into that has no hollow. Threads: those of the scene.
#pragma once

#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/body_geoms.h"
#include "robocell/task/held_motion.h"

namespace robocell::internal {

// Returns the names of a vessel's grains.
std::vector<std::string> GrainsOf(const Scene& scene, const std::string& vessel);

// The inside of a vessel, from the bottom of its hollow to its rim.
class Vessel {
 public:
  Vessel(const Scene& scene, const std::string& name);
  // Returns true if a point of the world is within its outline, over its bottom and under its rim.
  bool Contains(const Eigen::Vector3d& point) const;
  // Returns the middle of its opening in its body's frame.
  Eigen::Vector3d mouth() const;
  // Returns the middle of its bottom, and half its least width.
  Eigen::Vector3d bottom() const;
  double radius() const;
  Pose pose() const { return geoms_.body().pose_in_world(); }

 private:
  Scene scene_;
  BodyGeoms geoms_;
  Hollow hollow_;
};

RelationKind PouredIntoRelation();
// Returns paths of a vessel that is carried upright, tilted over another one and back, with its mouth
// turned by various angles about the vertical.
std::vector<HeldPath> PourPaths(const Scene& scene, const StatedRelation& stated,
                                const Pose& lifted);

}  // namespace robocell::internal
