// Cell: a scene that acts: its robots, its clock and its task. One step of it sends commands,
// simulates until the step ends, and asks the task for its verdict. Environments (env.h), rollouts
// (rollout/rollout.h) and runs as environments (rollout/run_env.h) all step here, so that an action
// has the same effect and the same verdict wherever it is made.
//
//   Cell cell(scene, RobotsOf(scene), {.control_ticks = 33}, task.get(), "run 'picks'");
//   cell.Begin();
//   CellStep step = cell.Step({.send = [&] { return cell.Send(action); }});
//   if (step.ok() && step.verdict.success) ...
//
// A step that diverged has no verdict. Throws the errors of the stepper and of the task's judge.
// The task has to outlive the cell. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/env/stepper.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task_judge.h"

namespace robocell::internal {

struct CellStep : StepOutcome {
  TaskVerdict verdict = {};  // zeros without a task
};

struct CellCommand {
  // Sends the commands of the step to the robots: Cell::Send, or what knows them.
  std::function<StepOutcome()> send;
  // The step ends after so many control ticks, by default those of the rates, or earlier once
  // `done`, called after each one, returns true.
  std::optional<int64_t> most_ticks = {};
  StopRequest done = {};
  // Called after a simulation that did not diverge. If it returns true it has gone back to the
  // state before the step: the step is simulated once more, with the targets that the robots had.
  std::function<bool()> goes_back = {};
};

class Cell {
 public:
  // `task` may be null. `place` begins messages about its verdicts; "" for none.
  Cell(Scene scene, std::vector<Robot> robots, StepperRates rates, Task* task,
       std::string place = "");

  // Begins the task's episode; the scene is in its start state.
  void Begin();
  // The task is in another episode now.
  void ForgetSubtasks();
  // Returns the names of the task's subtasks in this episode.
  std::vector<std::string> subtasks();

  // Sets the robots' targets.
  StepOutcome Send(const Action& action) { return stepper_.Apply(action); }
  CellStep Step(const CellCommand& command);

  // Actions take effect so many control ticks after the beginning of their step.
  void set_action_delay(int64_t ticks) { action_delay_ = ticks; }
  int64_t action_delay() const { return action_delay_; }

  void set_on_control_tick(OnControlTick callback) {
    stepper_.set_on_control_tick(std::move(callback));
  }
  const std::vector<Robot>& robots() const { return stepper_.robots(); }
  void DropTask() { judge_.reset(); }

 private:
  void Simulate(const CellCommand& command, StepOutcome& outcome);
  StepOutcome SimulateDelayed(const CellCommand& command);

  Stepper stepper_;
  // Says that episodes step the scene (scene/step_gate.h).
  std::shared_ptr<SceneObserver> mark_ = std::make_shared<SceneObserver>();
  std::optional<TaskJudge> judge_;  // with a task
  int64_t action_delay_ = 0;
};

}  // namespace robocell::internal
