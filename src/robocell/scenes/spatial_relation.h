// SpatialRelation: whether an object is on top of, inside or next to something now; for what a task
// asks for, and for starts.
//
//   const SpatialRelation in_drawer(scene, "spoon", Relation::kInside, "drawer");
//   if (in_drawer.Holds()) ...
//
// On top of: it touches the other from above. Inside: its middle is over a hollow of the other
// (scene_annotations.h) and it reaches below the rim; hollows are measured when a SpatialRelation is
// made. Next to: the free distance between the two, along the line between their middles, is at most
// `most_gap`, and it is neither on nor in it. Names are those of objects and bodies.
//
// Errors: NotFoundError for names that the scene does not have; ArgumentError for an object without a
// shape that collides and for `inside` of what has no hollow. Threads: those of the scene.
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

  // Poses and contacts of the scene are up to date.
  bool Holds() const;

  const Scene& scene() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell
