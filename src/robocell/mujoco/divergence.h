// Divergence as a value: what a step says about the state it left behind.
//
//   StepResult result = Step(model, data, 10);     // step.h
//   if (result.status == StepResult::kDiverged) LogWarn(result.message);
//
// A state has diverged when a position, velocity or acceleration is not finite or larger than the
// engine accepts (mjMAXVAL, 1e10), or when time did not advance by one timestep (the engine's
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

// True when the state is not finite, out of bounds, or when time did not advance by one timestep.
// Allocates nothing.
bool HasDiverged(const mjModel* model, const mjData* data, const StepStart& start);

// The value for a state that HasDiverged, which says where. `steps` is copied into it.
StepResult Diverged(const mjModel* model, const mjData* data, const StepStart& start, int steps);

}  // namespace robocell
