// Servos that oscillate, and what calms them. A servo that is stiff or strongly damped for the
// little inertia that it moves overshoots with every timestep, in MuJoCo as such; it looks like a
// joint that is blocked or too weak. Changes of the model are tried in a copy, from a given state,
// with the controls as they are.
//
//   const SwingTrial trial{model, data, joints, "left_"};
//   if (!SwingingJoints(trial).empty()) Report(FindSwingCure(trial));
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct SwingTrial {
  const mjModel* model = nullptr;
  const mjData* start = nullptr;  // state and controls
  std::vector<int> joints = {};   // hinges and slides that may swing
  std::string_view prefix = {};   // of the robot's names, left out in edits
};

// Returns those of the joints that move in both directions faster than 0.05 rad/s (m/s) during the
// last 0.3 s of a second, and turn back at least four times in that. All of them if the simulation
// diverges. Throws EngineError.
std::vector<int> SwingingJoints(const SwingTrial& trial);

// What brought all joints to rest in a trial.
struct SwingCure {
  std::vector<std::string> edits = {};  // "{joint: 'j5', armature: 0.02}"
  double timestep = 0;                  // s, which alone does it too; 0: none that was tried

  bool found() const { return !edits.empty() || timestep > 0; }
  // Returns a sentence: "In a trial `edits: [...]` brought it to rest, and so did a timestep of
  // 0.0005 s", or that nothing helped.
  std::string Text() const;
};

// Tries, on the joints that swing, the armature of a rotor, damping, and lower gains of their servos,
// in this order, and then smaller timesteps. Takes up to a few seconds.
SwingCure FindSwingCure(const SwingTrial& trial);

}  // namespace robocell::internal
