#include "robocell/env/cell.h"

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

CellStep Cell::Step(const CellCommand& command) {
  CellStep step{command.send(), {}};
  Simulate(command, step);
  if (step.ok() && command.goes_back && command.goes_back()) Simulate(command, step);
  if (step.ok() && judge_) step.verdict = judge_->Judge();
  return step;
}

}  // namespace robocell::internal
