// GraspCheck: refuses a start in which the robot can grasp an object in no way from where it stands. A
// task keeps one and asks it in CheckStart:
//
//   std::optional<Refusal> CheckStart(const Scene& scene) override {
//     return grasps_.Check(scene, robot_, scene.compiled()->object("cup").root_body, 0.05);
//   }
//
// It looks for the same grasps as the scripted expert (expert/pick_planner.h): from above, and where
// none fits or all collide from the sides; then straight up by `lift_height` (metres) and a little
// more. It does not plan the path to them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "robocell/motion/planning_scene.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/refusal.h"

namespace robocell {

class GripperShape;

// The reasons of refusals (refusal.h). A grasp that no base pose reaches is counted as such.
inline constexpr const char* kNoGrasp = "no grasp";
inline constexpr const char* kGraspsInCollision = "something is in the way of every grasp";

// Refuses a grasp in reach that is of no use to the task. It may change the planning scene.
using GraspCondition = std::function<std::optional<Refusal>(PlanningScene&, const GraspMotion&)>;

class GraspCheck {
 public:
  // `body`: the object's root body. A few grasps in reach are tried: one of them has to be usable.
  // `sides_too`: those from the sides are tried as well if those from above are of no use.
  // Robots without a gripper, and those whose gripper cannot be measured, pass: they come with
  // experts of their own, which check what they can hold.
  std::optional<Refusal> Check(const Scene& scene, const Robot& robot, const std::string& body,
                               double lift_height, const GraspCondition& refuse = {},
                               bool sides_too = false);

 private:
  std::string robot_;  // its name
  // The gripper's shape, which reads the disk and stays the same for one start.
  std::shared_ptr<const GripperShape> shape_;
};

}  // namespace robocell
