// Insertion: how deep an object is in a hole. A hole is a site that fills it, a box or a cylinder
// whose z axis points out of the mouth.
//
//   const Insertion insertion(scene, "peg", "block");   // the one site of block whose name ends in "hole"
//   if (insertion.Depth() >= 0.8 * insertion.full_depth()) ...
//
// The relation `inserted` (relations.h) is about this share. Throws NotFoundError for unknown names,
// and ArgumentError for an object without a shape that collides and for something that is no hole.
// Threads: those of the scene.
#pragma once

#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/relations.h"

namespace robocell::internal {

class Insertion {
 public:
  // `hole`: a site, or an object or body with one site whose name ends in "hole".
  Insertion(const Scene& scene, const std::string& object, const std::string& hole);

  // Returns the pose of the hole's mouth in the world, z outwards.
  Pose mouth() const;
  // Returns how far the object goes into the hole, m: the hole's depth, or the object's length.
  double full_depth() const;
  // Returns the length of the object between the mouth and the bottom of the hole, m. Negative for one
  // over the mouth or under the bottom: the distance from there. 0 for one beside the hole.
  double Depth() const;
  // Returns the distance of the object's deepest part from the hole's axis, m.
  double Aside() const;
  // Returns the pose in which the object, turned about the hole's axis, is so deep in it. The z axis
  // of the object is then that of the mouth, and its origin is on the hole's axis.
  Pose PoseAt(double yaw, double depth) const;
  // Returns the poses of a full insertion, a little above the bottom, in which the object is free of
  // everything, at most `count`: those of equally spaced turns about the axis.
  std::vector<Pose> FreePoses(int count) const;

 private:
  struct Tip {
    double along;              // as Depth(), without a look at what is beside the hole
    Eigen::Vector2d in_mouth;  // across
  };
  Tip DeepestPart() const;
  double hole_depth() const;
  bool Contains(const Eigen::Vector2d& in_mouth) const;

  Scene scene_;
  BodyHandle body_;
  std::string site_;
};

RelationKind InsertedRelation();

}  // namespace robocell::internal
