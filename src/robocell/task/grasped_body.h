// The part of an object that moves as one with a body, and the object's other parts.
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/scenes/handle_geoms.h"  // IWYU pragma: export

namespace robocell::internal {

struct GraspedBody {
  int body = -1;
  std::string name;              // full name of the body
  std::string object;            // name of the object that it belongs to, "" for none
  std::vector<int> geoms;        // colliding geoms of the body and of what is fixed to it
  std::vector<int> other_geoms;  // those of the rest of the object, such as the frame of a door
};

// `name`: of an object, for its root body, or of a body. Throws NotFoundError with the objects and
// bodies.
GraspedBody FindGraspedBody(const Scene& scene, const std::string& name);

}  // namespace robocell::internal
