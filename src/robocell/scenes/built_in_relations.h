// The relations that know no robot (relations.h).
#pragma once

#include <map>
#include <string>

#include "robocell/scenes/relations.h"

namespace robocell::internal {

std::map<std::string, RelationKind> BuiltInRelations();

}  // namespace robocell::internal
