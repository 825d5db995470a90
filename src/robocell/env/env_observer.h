// EnvObserver: receives the events of a running environment: beginnings of episodes, actions, the
// controls that act on the engine at each control tick, and ends of steps. Recorders
// (rollout/env_recorder.h) are observers.
//
//   class TickCounter : public EnvObserver {
//     void OnControlTick(const mjModel*, const mjData*) override { ++ticks_; }
//   };
//   TickCounter counter;
//   env.AddObserver(&counter);
//
// Functions are called on the thread that steps the environment, and may read it. Their exceptions
// leave Reset, SetState or Step: from OnAction and OnCommands before anything moves, from OnControlTick halfway,
// like any error of a step.
#pragma once

#include <span>

#include "robocell/mujoco/forward.h"
#include "robocell/robot/action.h"

namespace robocell {

struct EnvStep;

class EnvObserver {
 public:
  virtual ~EnvObserver() = default;
  // A reset or a restored state is complete: an episode begins.
  virtual void OnStart() {}
  // A step begins with a well-formed action; the environment is in the state after the last step.
  virtual void OnAction(std::span<const double> /*action*/) {}
  // The same for commands by the names of features (Env::Act).
  virtual void OnCommands(const Action& /*commands*/) {}
  // The robots were updated: `data->ctrl` acts on the engine until the next tick.
  virtual void OnControlTick(const mjModel* /*model*/, const mjData* /*data*/) {}
  // A guard goes back to the beginning of the step: its ticks so far no longer count.
  virtual void OnTakenBack() {}
  // The step has ended; the environment shows the result.
  virtual void OnStep(const EnvStep& /*step*/) {}
};

}  // namespace robocell
