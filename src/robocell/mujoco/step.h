// Guarded simulation steps that report divergence as a value. The hot path: we allocate nothing
// while all is well.
//
//   StepResult result = Step(model, data, 10, "scene 'pick'");
//   if (!result.ok()) EndEpisode(result.message);
//
// Throws EngineError if the engine reports a fatal error (reset the data before the next step).
// Threads: one user of `data` at a time; `model` may be shared if nobody writes to it.
#pragma once

#include <string_view>

#include "robocell/mujoco/divergence.h"
#include "robocell/mujoco/forward.h"

namespace robocell {

// Makes `n` engine steps; stops after the first one that diverged. n <= 0 does nothing.
StepResult Step(const mjModel* model, mjData* data, int n = 1, std::string_view context = {});

// Recomputes everything that follows from the state (mj_forward).
void Forward(const mjModel* model, mjData* data, std::string_view context = {});

}  // namespace robocell
