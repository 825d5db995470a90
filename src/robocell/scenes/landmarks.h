// Landmarks: surfaces and spaces for placing objects: the level tops of a body or object of a
// scene, the floors of its hollows, its extent, and its support.
//
//   const Landmarks landmarks(scene, DeriveAnnotations(spec));
//   for (const LevelArea& spot : landmarks.Tops("shelf")) ...   // spot.frame_to_world * (x, y, 0)
//
// Names are those of objects and of bodies of the compiled scene; NotFoundError suggests the
// nearest. Poses are those at the construction of a Landmarks. Metres.
#pragma once

#include <string>
#include <vector>

#include "robocell/math/level_area.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {

// Returns the root body of an object, else the body of this name; -1 if there is none.
int FindObjectOrBody(const Scene& scene, const std::string& name);
// Throws NotFoundError that suggests the nearest.
int RequireObjectOrBody(const Scene& scene, const std::string& name);
std::vector<std::string> NamesOfObjectsAndBodies(const Scene& scene);

class Landmarks {
 public:
  Landmarks(Scene scene, SceneAnnotations annotations);

  bool Has(const std::string& name) const { return FindObjectOrBody(scene_, name) >= 0; }
  std::vector<std::string> Names() const { return NamesOfObjectsAndBodies(scene_); }
  // Returns its surfaces for other objects: the level faces of it and its subtree in the
  // annotations, largest first; else the level part around the middle of its top, which may have no
  // extent. Empty for an object without a shape that collides.
  std::vector<LevelArea> Tops(const std::string& name) const;
  // Returns the level floors of its hollows, largest first.
  std::vector<LevelArea> Floors(const std::string& name) const;
  // Returns its support: the annotated face or the floor that is next under its lowest point;
  // without one, a spot of no extent under it.
  LevelArea Ground(const std::string& name) const;
  // The face or floor that is next under a point, as Ground; a spot of no extent without one.
  LevelArea GroundUnder(const Eigen::Vector3d& point) const { return NextUnder(point, -1); }
  // Returns its root body's origin, in the world.
  Eigen::Vector3d Origin(const std::string& name) const;
  // Returns its extent from there along a unit vector of the world.
  double ReachAlong(const std::string& name, const Eigen::Vector3d& direction) const;

 private:
  int RequireBody(const std::string& name) const { return RequireObjectOrBody(scene_, name); }
  bool IsPartOf(const std::string& part, int body) const;
  std::vector<LevelArea> MiddleOfTop(int body) const;
  double LowestOf(int body) const;
  LevelArea NextUnder(const Eigen::Vector3d& point, int without) const;  // faces of that body

  Scene scene_;
  SceneAnnotations annotations_;
};

}  // namespace robocell::internal
