#include "robocell/env/env_step.h"

#include <fmt/format.h>

namespace robocell {

const char* ToString(EndReason reason) {
  switch (reason) {
    case EndReason::kDiverged:
      return "diverged";
    case EndReason::kCollision:
      return "collision";
    case EndReason::kIkFailed:
      return "ik_failed";
    case EndReason::kArrived:
      return "arrived";
    case EndReason::kSettled:
      return "settled";
    case EndReason::kStopped:
      return "stopped";
    case EndReason::kTimeout:
      break;
  }
  return "timeout";
}

std::string Describe(const Collision& collision) {
  return fmt::format(
      "robot '{}' ({}) touches {}", collision.robot, collision.body,
      collision.other_robot.empty()
          ? collision.other_body
          : fmt::format("robot '{}' ({})", collision.other_robot, collision.other_body));
}

}  // namespace robocell
