// BodyHandle: a body of a scene whose name is looked up once, and again after the scene was
// compiled again; for code that needs poses at every step.
//
//   BodyHandle cube(scene, "cube");
//   Pose pose = cube.pose_in_world();
//
// Throws NotFoundError, when it is made or used, for a name that the scene does not have. Threads:
// those of the scene.
#pragma once

#include <string>

#include "robocell/scene/scene.h"

namespace robocell {

class BodyHandle {
 public:
  BodyHandle(const Scene& scene, std::string name);

  const std::string& name() const { return name_; }
  int id() const;  // id in the present model
  Pose pose_in_world() const;

 private:
  Scene scene_;
  std::string name_;
  mutable int id_ = -1;
  mutable uint64_t generation_ = 0;  // the generation of id_; no scene has 0
};

}  // namespace robocell
