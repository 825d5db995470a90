// EnvObserver: what an environment says of itself while it runs: where episodes begin, what is
// asked of it, what acts on the engine at each control tick, and how steps end. Recorders
// (rollout/env_recorder.h) are observers.
//
//   class TickCounter : public EnvObserver {
//     void OnControlTick(const mjModel*, const mjData*) override { ++ticks_; }
//   };
//   TickCounter counter;
//   env.AddObserver(&counter);
//
// Functions are called on the thread that steps the environment, and may read it. What they throw
// comes out of Reset, SetState or Step: from OnAction before anything moves, from OnControlTick
// halfway, like any error of a step.
#pragma once

#include <span>

#include "robocell/mujoco/forward.h"

namespace robocell {

struct EnvStep;

class EnvObserver {
 public:
  virtual ~EnvObserver() = default;
  // A reset or going back to a state is done: an episode begins.
  virtual void OnStart() {}
  // A step begins with an action that is well-formed; the environment is as the last step left it.
  virtual void OnAction(std::span<const double> /*action*/) {}
  // The robots were updated: `data->ctrl` acts on the engine until the next tick.
  virtual void OnControlTick(const mjModel* /*model*/, const mjData* /*data*/) {}
  // A guard goes back to the begin of the step: its ticks so far count no longer.
  virtual void OnTakenBack() {}
  // The step has ended; the environment shows what came of it.
  virtual void OnStep(const EnvStep& /*step*/) {}
};

}  // namespace robocell
