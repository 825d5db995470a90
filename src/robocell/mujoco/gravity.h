// The gravity that acts in a model: flags of its options switch it, and its compensation, off
// without changing the numbers.
#pragma once

#include <mujoco/mujoco.h>

namespace robocell::internal {

// Returns the gravity that acts on bodies, x y z in the world, m/s^2; zeros if `mjDSBL_GRAVITY` is
// set. Points into the model, or to constants. Inline, because control loops call it.
inline const mjtNum* EffectiveGravity(const mjModel* model) {
  static constexpr mjtNum kNone[3] = {0, 0, 0};
  return model->opt.disableflags & mjDSBL_GRAVITY ? kNone : model->opt.gravity;
}

// Returns true if bodies' `gravcomp` counts. It is a passive force, and the engine computes none if
// both springs and dampers are off. For a model that was compiled without compensation, the engine
// ignores later values unless the flag is raised too.
inline bool CompensatesGravity(const mjModel* model) {
  constexpr int kPassive = mjDSBL_SPRING | mjDSBL_DAMPER;
  return model->flg_gravcomp && (model->opt.disableflags & kPassive) != kPassive;
}

}  // namespace robocell::internal
