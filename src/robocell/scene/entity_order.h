// Private to scene: the order in which entities are added, so that each comes after what it is
// attached to. Ties keep the order objects, robots, cameras, and within a list the list's.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/compile_log.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

// One entity as the order sees it. Entities are given in the order of ties.
struct Entity {
  std::string place;  // "object 'cube'"
  std::string list;   // "objects": within one list nothing refers to a later entry
  AttachTarget target;
  std::string robot;  // its name when it is a robot
  std::set<std::pair<AttachKind, std::string>>
      elements;  // bodies, sites and frames it brings, full names
};

// Indices into `entities` in the order of building. Elements that the scene's base has are in
// `base`. Missing targets, references to later entries of the same list and cycles are problems;
// entities that take part in them are left out.
std::vector<size_t> BuildOrder(const std::vector<Entity>& entities,
                               const std::set<std::pair<AttachKind, std::string>>& base,
                               CompileLog& log);

}  // namespace robocell::internal
