// What a caller of GenerateGrasps or GraspsOf asks for, checked before anything is looked up or
// computed, so that a mistake gets the same error whether grasps are stored or not.
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/grasped_body.h"

namespace robocell::internal {

struct GraspRequest {
  GraspedBody grasped;
  std::shared_ptr<const GripperShape> shape;
  std::vector<GraspKind> kinds;  // those asked for, else all that hold and that the hand can do
  std::vector<int> geoms;        // ids of the geoms that the options name

  bool Wants(GraspKind kind) const;
};

// Throws NotFoundError for names that the scene does not have, ArgumentError for geoms of other
// bodies and for options that are out of range or do not fit the hand.
GraspRequest CheckedRequest(const Robot& robot, const std::string& body,
                            const GraspOptions& options);

// Returns the kind of a grasp between two fingers by its direction in the frame of the body: kTop,
// kSide or kAntipodal.
GraspKind KindOfApproach(const Eigen::Vector3d& approach);

}  // namespace robocell::internal
