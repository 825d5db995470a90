#include "robocell/env/cell.h"

#include <algorithm>
#include <utility>

#include "robocell/scene/step_gate.h"

namespace robocell::internal {

Cell::Cell(Scene scene, std::vector<Robot> robots, StepperRates rates, Task* task,
           std::string place)
    : stepper_(scene, std::move(robots), rates) {
  scene.AddObserver(mark_, kEpisodesKey);
  if (task) judge_.emplace(*task, std::move(scene), std::move(place));
}

void Cell::Begin() {
  if (judge_) judge_->Begin();
}

void Cell::ForgetSubtasks() {
  if (judge_) judge_->ForgetSubtasks();
}

std::vector<std::string> Cell::subtasks() {
  return judge_ ? judge_->subtasks() : std::vector<std::string>();
}

void Cell::Simulate(const CellCommand& command, StepOutcome& outcome) {
  if (!command.most_ticks && !command.done) return stepper_.Simulate(outcome);
  const int64_t most = command.most_ticks.value_or(stepper_.rates().control_ticks);
  stepper_.SimulateUntil(outcome, most, command.done);
}

// Simulates with the old targets, sends the commands, and simulates the rest of the step.
StepOutcome Cell::SimulateDelayed(const CellCommand& command) {
  const int64_t most = command.most_ticks.value_or(stepper_.rates().control_ticks);
  const int64_t early = std::min(action_delay_, most);
  bool is_over = false;
  const StopRequest done = [&] { return is_over = ShouldStop(command.done); };
  StepOutcome before;
  stepper_.SimulateUntil(before, early, done);
  if (!before.ok()) return before;
  // A viewer may have held or stopped the simulation.
  is_over |= before.step.steps < early * stepper_.rates().sim_steps;
  StepOutcome outcome = command.send();
  if (is_over || early == most) {
    outcome.step = before.step;
    return outcome;
  }
  stepper_.SimulateUntil(outcome, most - early, command.done);
  outcome.step.steps += before.step.steps;
  return outcome;
}

CellStep Cell::Step(const CellCommand& command) {
  const bool is_delayed = action_delay_ > 0;
  CellStep step{is_delayed ? SimulateDelayed(command) : command.send(), {}};
  if (!is_delayed) Simulate(command, step);
  if (step.ok() && command.goes_back && command.goes_back()) Simulate(command, step);
  if (step.ok() && judge_) step.verdict = judge_->Judge();
  return step;
}

}  // namespace robocell::internal
