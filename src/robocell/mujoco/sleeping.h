// Bodies that sleep (options: {enable: [sleep]}). The engine lists no contacts between two of them, nor
// between one and a body that never moves: whoever asks what touches what has to know who sleeps.
#pragma once

#include <mujoco/mujoco.h>

namespace robocell::internal {

// Returns true if the body sleeps: it is at rest on something, which may be asleep too. The state is
// that of the last step or forward pass.
inline bool Sleeps(const mjModel* model, const mjData* data, int body) {
  return (model->opt.enableflags & mjENBL_SLEEP) && data->body_awake[body] == mjS_ASLEEP;
}

}  // namespace robocell::internal
