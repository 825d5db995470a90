#include "robocell/mujoco/step.h"

#include <mujoco/mujoco.h>

#include "robocell/mujoco/guard.h"

namespace robocell {

StepResult Step(const mjModel* model, mjData* data, int n, std::string_view context) {
  int steps = 0;
  StepStart start;
  bool diverged = false;
  internal::Guarded(context, data, [&] {
    while (steps < n && !diverged) {
      start = BeginStep(data);
      mj_step(model, data);
      ++steps;
      diverged = HasDiverged(model, data, start);
    }
  });
  StepResult result;  // made once, directly in the caller's object
  if (diverged) {
    result = Diverged(model, data, start, steps);
  } else {
    result.steps = steps;
    result.time = data->time;
  }
  return result;
}

void Forward(const mjModel* model, mjData* data, std::string_view context) {
  internal::Guarded(context, data, [&] { mj_forward(model, data); });
}

}  // namespace robocell
