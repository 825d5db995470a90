// Stepper: the clock that drives robots and engine, shared by Env, the episode runner and batches.
// Each control tick calls every robot's Update() and then steps the engine; at each policy tick the
// caller reads sensors and cameras.
//
//   Stepper stepper(scene, robots, {.control_ticks = 33, .sim_steps = 1});
//   StepOutcome outcome = stepper.Advance(action);
//   if (!outcome.ok()) EndEpisode(outcome.step.message);
//
// Ticks are counted in whole engine steps, so they do not drift. Control ticks allocate nothing;
// Robot::Apply, at the policy rate, does. Throws the errors of Robot::Apply and Robot::Update.
// Divergence is a value. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/base/stop.h"
#include "robocell/robot/action.h"
#include "robocell/robot/control_ticks.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell {

struct StepperRates {
  int control_ticks = 33;  // per policy tick
  int sim_steps = 1;       // per control tick
};

struct StepOutcome {
  StepResult step = {};           // result of the policy tick: engine steps done, diverged or not
  std::string failed_robot = {};  // the first whose pose command had no IK solution; it kept its
  std::string failed_group = {};  // target
  IkResult ik = {};               // how near it came to the pose
  bool ok() const { return step.ok(); }
};

class Stepper {
 public:
  // Throws ArgumentError for rates below 1 and for robots of another scene.
  Stepper(Scene scene, std::vector<Robot> robots, StepperRates rates);

  void set_on_control_tick(OnControlTick callback) { on_control_tick_ = std::move(callback); }
  // Applies the action and advances by one policy tick. Stops at divergence. Throws NotFoundError
  // for an unknown robot before anything is applied.
  StepOutcome Advance(const Action& action);
  // The two halves of Advance, for callers that distinguish an error of the action from one of the
  // simulation.
  StepOutcome Apply(const Action& action);
  void Simulate(StepOutcome& outcome);
  // The second half of AdvanceUntil.
  void SimulateUntil(StepOutcome& outcome, int64_t most_ticks, const StopRequest& done);
  // Like Advance, but for as many control ticks as it takes until `done()`, called after each one,
  // returns true; `most_ticks` at most.
  StepOutcome AdvanceUntil(const Action& action, int64_t most_ticks, const StopRequest& done);

  // Returns the number of calls of Advance and AdvanceUntil that did not throw.
  int64_t policy_ticks() const { return policy_ticks_; }
  const std::vector<Robot>& robots() const { return robots_; }
  const Scene& scene() const { return scene_; }
  const StepperRates& rates() const { return rates_; }

 private:
  Robot& Find(const std::string& name);

  Scene scene_;
  std::vector<Robot> robots_;
  StepperRates rates_;
  OnControlTick on_control_tick_;
  int64_t policy_ticks_ = 0;
};

}  // namespace robocell
