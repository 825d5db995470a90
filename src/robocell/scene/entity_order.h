// Private to scene: the order in which entities are added, so that each comes after the one that it
// is attached to. Ties keep the order objects, robots, cameras, and the order within each list.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/compile_log.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

// An entity to be ordered. Entities are given in the order of ties.
struct Entity {
  std::string place;  // "object 'cube'"
  std::string list;   // "objects": within one list no entry refers to a later one
  AttachTarget target;
  std::string robot;  // its name if it is a robot
  std::set<std::pair<AttachKind, std::string>>
      elements;  // bodies, sites and frames it brings, full names
};

// Returns indices into `entities` in the order of building. `base` has the elements of the scene's
// base. Missing targets, references to later entries of the same list and cycles are problems;
// entities that take part in them are left out.
std::vector<size_t> BuildOrder(const std::vector<Entity>& entities,
                               const std::set<std::pair<AttachKind, std::string>>& base,
                               CompileLog& log);

}  // namespace robocell::internal
