// Paths of a hand that pushes an object over its support to a place: two fingertips behind it, or
// the closed hand, on the line from the object to the place.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/contact_motion.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

// The reason for pushes that no path exists for: the object is at the place.
inline constexpr const char* kNoPush = "no way to push it";

// `object`: an object or body; its centre of mass is to come to `place` (world, x and y). The paths
// end where fingers without thickness would have pushed it there: the hand stops when it is there.
std::vector<ContactPath> PushPaths(const Scene& scene, const std::string& object,
                                   const Eigen::Vector2d& place, const GripperShape& shape);
// Refuses a start in which the robot cannot follow any of these.
std::optional<Refusal> CheckPush(const Scene& scene, const Robot& robot, const std::string& object,
                                 const Eigen::Vector2d& place);

}  // namespace robocell::internal
