// The gravity that acts in a model: flags of its options switch it, and what compensates it, off
// without touching the numbers.
#pragma once

#include <mujoco/mujoco.h>

namespace robocell::internal {

// The field that bodies fall in, x y z in the world, m/s^2; zeros where `mjDSBL_GRAVITY` is set.
// Points into the model, or to constants. In place, because control loops ask.
inline const mjtNum* EffectiveGravity(const mjModel* model) {
  static constexpr mjtNum kNone[3] = {0, 0, 0};
  return model->opt.disableflags & mjDSBL_GRAVITY ? kNone : model->opt.gravity;
}

// Returns true if bodies' `gravcomp` counts. It is a passive force, and the engine computes none
// where both springs and dampers are off. Nor does it look at the numbers of a model that was
// compiled without any, whatever was written to them since, unless the flag is raised too.
inline bool CompensatesGravity(const mjModel* model) {
  constexpr int kPassive = mjDSBL_SPRING | mjDSBL_DAMPER;
  return model->flg_gravcomp && (model->opt.disableflags & kPassive) != kPassive;
}

}  // namespace robocell::internal
