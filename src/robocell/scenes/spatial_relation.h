// SpatialRelation: checks whether an object is now on top of, inside or next to another one; for
// conditions of tasks, and for starts.
//
//   const SpatialRelation in_drawer(scene, "spoon", Relation::kInside, "drawer");
//   if (in_drawer.Holds()) ...
//
// On top of: it touches the other from above. Inside: its centre is over a hollow of the other
// (scene_annotations.h) and it reaches below the rim; hollows are measured at construction. Next
// to: the free distance between the two, along the line between their centres, is at most
// `most_gap`, and it is neither on nor in it. Names are those of objects and bodies.
//
// Throws NotFoundError for unknown names, and ArgumentError for an object without a shape that
// collides and for `inside` of an object without a hollow. Threads: those of the scene.
#pragma once

#include <memory>
#include <string>

#include "robocell/scene/scene.h"
#include "robocell/spec/object_place.h"

namespace robocell {

class SpatialRelation {
 public:
  SpatialRelation(const Scene& scene, const std::string& object, Relation relation,
                  const std::string& reference, double most_gap = kMostGap);
  ~SpatialRelation();
  SpatialRelation(SpatialRelation&&) noexcept;
  SpatialRelation& operator=(SpatialRelation&&) noexcept;

  // Requires up-to-date poses and contacts of the scene.
  bool Holds() const;

  const Scene& scene() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell
