// The control loop, in one place: each control tick calls every robot's Update() and then steps the
// engine. Stepper drives episodes with it, samplers let objects come to rest with it.
//
//   StepResult result = RunControlTicks(scene, robots, {.ticks = 33, .sim_steps = 1});
//   if (!result.ok()) return Refuse(result.message);
//
// No allocation. Throws the errors of Robot::Update. Divergence is a value. Threads: those of the
// scene.
#pragma once

#include <functional>
#include <span>

#include "robocell/mujoco/forward.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell {

struct ControlTicks {
  int ticks = 1;
  int sim_steps = 1;  // per tick
};

// Called after every tick's Update(), before the engine's steps: data->ctrl is what will act.
using OnControlTick = std::function<void(const mjModel*, const mjData*)>;

// Stops at divergence, and when a viewer holds or stops the scene's steps. Returns the result of all ticks: engine steps done, diverged or not.
StepResult RunControlTicks(Scene& scene, std::span<Robot> robots, ControlTicks count,
                           const OnControlTick& on_tick = {});

}  // namespace robocell
