// ExactReplay: judges a rollout a second time, by its controls alone: from the same state, applied
// tick by tick, they have to make the task a success again.
//
//   ExactReplay replay(scene, task, rates);   // in the start state
//   ... each control tick: replay.Put(data->ctrl);
//   const std::string why_not = replay.Judge();
//
// The scene is then in the state at the end of the replay. The task has to outlive it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/env/stepper.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task.h"

namespace robocell::internal {

class ExactReplay {
 public:
  ExactReplay(Scene scene, Task& task, StepperRates rates);

  void Put(std::span<const double> ctrl) { ctrl_.insert(ctrl_.end(), ctrl.begin(), ctrl.end()); }
  // Returns why the replay is not a success, one of few texts; "" if it is.
  std::string Judge();

 private:
  Scene scene_;
  Task& task_;
  StepperRates rates_;
  std::vector<double> state_;
  std::vector<double> ctrl_;  // of each tick
};

}  // namespace robocell::internal
