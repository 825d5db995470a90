#include "robocell/expert/validate_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/task/grasp_motion.h"

namespace robocell {
namespace {

// As a text, to the millimetre: never more than it is, so that what is written there is accepted.
std::string AtMost(double metres) {
  return fmt::format("{:.3f}", std::floor(1000 * metres) / 1000);
}

}  // namespace

void ValidateReach(const PickRun& task, const BaseRange& base, const Robot& robot,
                   Problems& problems) {
  // From the bottom of what the robot stands on, which is what is placed, to its base frame.
  const Eigen::Vector3d up = (robot.base().pose().inverse() * robot.base_in_world()).translation();
  const double most = kReachShare * robot.reach();
  const double low = base.height_offset + base.height_noise[0] + up.z(),
               high = base.height_offset + base.height_noise[1] + up.z();
  const double height = low > 0 ? low : high < 0 ? -high : 0;  // the least there is
  const std::string reach = fmt::format(
      "the robot reaches {} m from its base frame, of which "
      "{:.0f} % is used",
      AtMost(robot.reach()), 100 * kReachShare);
  if (height > most) {
    problems.AddAt("start.base_height_offset",
                   fmt::format("{:g} m puts the base frame {:.2f} ... {:.2f} m above the object "
                               "(with base_height_noise, and {:.2f} m of what the robot stands "
                               "on), but {}",
                               base.height_offset, low, high, up.z(), reach));
    return;
  }
  // The arm that stands highest has least to lift, and the nearest the farthest to go.
  const double nearest = std::max(base.distance[0] - up.head<2>().norm(), 0.0);
  const double lift = GraspMotionsToLift(task.lift_height).lift;
  if (nearest < robot.reach()) {
    const double top = high + std::sqrt(robot.reach() * robot.reach() - nearest * nearest);
    if (lift > top) {
      problems.AddAt(
          "task.lift_height",
          fmt::format("{:g} m is more than the arm can lift: it reaches {:.2f} m from "
                      "its base frame, at most {:.2f} m above the object, and lifts "
                      "{:.2f} m more than is asked for; give at most {}",
                      task.lift_height, robot.reach(), std::max(top, 0.0), lift - task.lift_height,
                      AtMost(std::max(top - (lift - task.lift_height), 0.0))));
    }
  }
  const double farthest = std::sqrt(most * most - height * height) + up.head<2>().norm();
  if (base.distance[1] <= farthest) return;
  problems.AddAt("start.base_distance",
                 fmt::format("[{:g}, {:g}] m goes beyond {} m, from where the object is out of "
                             "reach: {}; give [smallest, largest] within that",
                             base.distance[0], base.distance[1], AtMost(farthest), reach));
}

}  // namespace robocell
