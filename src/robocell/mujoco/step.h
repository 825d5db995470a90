// Guarded simulation steps that report divergence as a value. The hot path: we allocate nothing
// while all is well.
//
//   StepResult result = Step(model, data, 10, "scene 'pick'");
//   if (!result.ok()) EndEpisode(result.message);
//
// A state has diverged when a position, velocity or acceleration is not finite or larger than the
// engine accepts (mjMAXVAL, 1e10), or when time did not advance by one timestep (the engine's
// automatic reset sets it back to zero; models built by robocell have it switched off). A diverged
// state is never valid data.
//
// Throws EngineError if the engine reports a fatal error (reset the data before the next step).
// Threads: one user of `data` at a time; `model` may be shared if nobody writes to it.
#pragma once

#include <string>
#include <string_view>

#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/warnings.h"

namespace robocell {

struct [[nodiscard]] StepResult {
  // kStopped: no step was made, since the user closed the window of a viewer that steps the scene
  // (scene/step_gate.h).
  enum Status { kOk, kDiverged, kStopped };

  Status status = kOk;
  int steps = 0;           // engine steps done, the diverged one included
  double time = 0;         // simulated seconds after the last step that was good
  int joint = -1;          // id of the first joint that shows it, -1 when it is not a joint's value
  std::string joint_name;  // "" when unnamed
  std::string
      message;  // "diverged at t=0.124 s: velocity of joint 'elbow' is nan (engine warnings: ...)"

  bool ok() const { return status == kOk; }
};

// The state before a step that is needed to judge it.
struct StepStart {
  double time = 0;
  EngineWarnings warnings;
};

StepStart BeginStep(const mjData* data);

// Returns true if the state is not finite or out of bounds, or if time did not advance by one
// timestep. Allocates nothing.
bool HasDiverged(const mjModel* model, const mjData* data, const StepStart& start);

// Returns the result for a diverged state, with its first joint. `steps` is copied into it.
StepResult Diverged(const mjModel* model, const mjData* data, const StepStart& start, int steps);

// Makes `n` engine steps; stops after the first one that diverged. n <= 0 does nothing.
StepResult Step(const mjModel* model, mjData* data, int n = 1, std::string_view context = {});

// Recomputes everything that follows from the state (mj_forward).
void Forward(const mjModel* model, mjData* data, std::string_view context = {});

}  // namespace robocell
