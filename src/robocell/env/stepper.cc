#include "robocell/env/stepper.h"

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {

Stepper::Stepper(Scene scene, std::vector<Robot> robots, StepperRates rates)
    : scene_(std::move(scene)), robots_(std::move(robots)), rates_(rates) {
  if (rates_.control_ticks < 1 || rates_.sim_steps < 1) {
    throw ArgumentError(fmt::format(
        "stepper: {} control ticks of {} engine steps per policy tick; both must be at least 1",
        rates_.control_ticks, rates_.sim_steps));
  }
  for (const Robot& robot : robots_) {
    if (robot.scene() == scene_) continue;
    throw ArgumentError(
        fmt::format("stepper: robot '{}' belongs to another scene ('{}') than the stepper's ('{}')",
                    robot.name(), robot.scene().name(), scene_.name()));
  }
}

Robot& Stepper::Find(const std::string& name) {
  std::vector<std::string> names;
  for (Robot& robot : robots_) {
    if (robot.name() == name) return robot;
    names.push_back(robot.name());
  }
  throw NotFoundError(NoSuchName("action", "robot", name, names));
}

StepOutcome Stepper::Apply(const Action& action) {
  StepOutcome outcome;
  for (const auto& [name, command] : action) Find(name);
  for (const auto& [name, command] : action) {
    const Robot::ApplyResult applied = Find(name).Apply(command);
    if (applied.ok || !outcome.failed_robot.empty()) continue;
    outcome.failed_robot = name;
    outcome.failed_group = applied.failed_group;
    outcome.ik = applied.ik;
  }
  return outcome;
}

void Stepper::Simulate(StepOutcome& outcome) {
  outcome.step =
      RunControlTicks(scene_, robots_, {rates_.control_ticks, rates_.sim_steps}, on_control_tick_);
  ++policy_ticks_;
}

StepOutcome Stepper::Advance(const Action& action) {
  StepOutcome outcome = Apply(action);
  Simulate(outcome);
  return outcome;
}

StepOutcome Stepper::AdvanceUntil(const Action& action, int64_t most_ticks,
                                  const StopRequest& done) {
  StepOutcome outcome = Apply(action);
  SimulateUntil(outcome, most_ticks, done);
  return outcome;
}

void Stepper::SimulateUntil(StepOutcome& outcome, int64_t most_ticks, const StopRequest& done) {
  outcome.step = {};
  for (int64_t tick = 0; tick < most_ticks && outcome.ok(); ++tick) {
    const int before = outcome.step.steps;
    outcome.step = RunControlTicks(scene_, robots_, {1, rates_.sim_steps}, on_control_tick_);
    outcome.step.steps += before;
    if (outcome.step.steps - before < rates_.sim_steps) break;  // held or stopped by a viewer
    if (outcome.ok() && ShouldStop(done)) break;
  }
  ++policy_ticks_;
}

}  // namespace robocell
