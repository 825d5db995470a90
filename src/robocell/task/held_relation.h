// The relation `held` of goals: robots hold the object and nothing else touches it (held.h). It is
// a goal, never a start.
#pragma once

namespace robocell::internal {

// Registers the relations that know robots, once. Called by everything that reads relations of
// tasks.
void RegisterTaskRelations();

}  // namespace robocell::internal
