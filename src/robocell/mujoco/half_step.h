// The first half of an engine step, ahead of the second: what follows from positions and velocities
// (frames, contacts, inertia, bias forces) is computed once, for controllers and for the step that
// they are controllers of.
//
//   HalfStep half;
//   half.Begin(model, data, "scene 'pick'");
//   ... data->ctrl from data->qfrc_bias, data->M, data->xpos ...
//   StepResult result = Step(model, data, 1, "scene 'pick'", &half);
//
// A step that goes on ends at the same bits as one that begins anew (mj_step1 and mj_step2 are
// mj_step). It begins anew when the state or the model's options were changed in between, or poses
// or bias forces computed anew. (A mark tells of poses: until the step, xpos[0] is -0.0.) And
// always where the engine's mj_step2 is not the rest of mj_step, or calls of others are part of it:
// other integrators than Euler's and the implicit ones, sleeping bodies, plugins, callbacks.
//
// Not noticed is what is changed of the model in between (a body's mass), nor other parts of what
// the first half wrote: contacts, inertia, actuator lengths, passive forces. Whoever computes such
// parts of another state (mj_transmission, mj_collision) calls Discard(), after which the step
// begins anew.
//
// Threads: as the data. No allocation but the first time, or for a larger model.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "robocell/mujoco/divergence.h"
#include "robocell/mujoco/forward.h"

namespace robocell {

class HalfStep {
 public:
  // Makes what follows from positions and velocities current, unless that was done for this very
  // state. Throws EngineError.
  void Begin(const mjModel* model, mjData* data, std::string_view context);
  void Discard() { begun_ = false; }
  // By somebody else, of the present state.
  void ContactsAreSolved() { unsolved_ = false; }
  // After Begin(), until the next step: contacts of the present state with their forces under the
  // present controls. Accelerations and forces of actuators stay those of the last step, and the
  // step that goes on is none the different. Throws EngineError.
  // Where others stepped the data, contacts have their forces already.
  void SolveContacts(const mjModel* model, mjData* data, std::string_view context);

  // Whether a step may go on from here, and if so what was before the first half. Once.
  bool Take(const mjModel* model, mjData* data, StepStart* start);

 private:
  bool IsAsLeft(const mjModel* model, const mjData* data) const;
  void Remember(const mjModel* model, mjData* data);

  bool begun_ = false, can_go_on_ = false;
  bool unsolved_ = false;  // the data has contacts without forces
  StepStart start_;
  // How it was left.
  const mjModel* model_ = nullptr;
  const mjData* data_ = nullptr;
  double time_ = 0;
  int ncon_ = 0, nefc_ = 0;
  std::vector<double> numbers_;
  std::vector<std::byte> options_;
  std::vector<unsigned char> are_active_;  // equality constraints
  std::vector<double> kept_;               // scratch
};

}  // namespace robocell
