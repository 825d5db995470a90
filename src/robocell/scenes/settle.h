// Settle: lets objects and robots come to rest together before an episode begins, with the robots
// controlled like in the episode.
//
//   const std::string why = Settle(scene, robots, "target", {.sim_steps = 2});  // "cube still moves"
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/stop.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// The default distance by which the target may move while it settles, metres.
inline constexpr double kMostSettling = 0.05;

struct SettleOptions {
  int sim_steps = 1;  // engine steps per control tick
  // Names of the objects that have to come to rest; all unless set.
  std::optional<std::vector<std::string>> resting = {};
  double most_drift = kMostSettling;
  StopRequest stop = {};  // once it returns true, objects may be refused as still moving
};

// Simulates until everything rests. Returns "" then, else why the scene does not settle: something
// diverges or does not come to rest, or the target ends up elsewhere. `target_body` may be empty.
// Simulated time advances.
std::string Settle(Scene& scene, std::span<Robot> robots, const std::string& target_body,
                   const SettleOptions& options);

}  // namespace robocell::internal
