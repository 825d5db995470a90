// The kinds of tasks of relation_tasks.h, for the registry of kinds.
#pragma once

#include "robocell/spec/kind_fields.h"

namespace robocell::internal {

// Adds the kinds with their fields and rules.
void AddRelationKinds(KindRegistry::Kinds& kinds);

}  // namespace robocell::internal
