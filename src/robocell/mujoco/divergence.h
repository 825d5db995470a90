// Divergence as a value: the result of a step about the state after it.
//
//   StepResult result = Step(model, data, 10);     // step.h
//   if (result.status == StepResult::kDiverged) LogWarn(result.message);
//
// A state has diverged if a position, velocity or acceleration is not finite or larger than the
// engine accepts (mjMAXVAL, 1e10), or if time did not advance by one timestep (the engine's
// automatic reset sets it back to zero; models built by robocell have it switched off). A diverged
// state is never valid data.
#pragma once

#include <string>

#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/warnings.h"

namespace robocell {

struct [[nodiscard]] StepResult {
  enum Status { kOk, kDiverged };

  Status status = kOk;
  int steps = 0;           // engine steps done, including the diverged one
  double time = 0;         // simulated seconds after the last valid step
  int joint = -1;          // id of the first joint with a bad value, -1 if not a joint's value
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

// Returns true if the state is not finite, out of bounds, or if time did not advance by one
// timestep. Allocates nothing.
bool HasDiverged(const mjModel* model, const mjData* data, const StepStart& start);

// Returns the value for a state that HasDiverged, with its place. `steps` is copied into it.
StepResult Diverged(const mjModel* model, const mjData* data, const StepStart& start, int steps);

}  // namespace robocell
