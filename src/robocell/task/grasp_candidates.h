// Grasp candidates of a pick: where a gripper could grasp an object from above, found with rays on the
// object's collision geometry. A suction gripper sticks to a flat place of its top
// (suction_grasps.h); the rest is about parallel grippers. This is pure geometry: the arm, its reach
// and the other objects play no part.
//
// A grasp is a place between the pads; the TCP follows from it by the gripper's shape at the
// object's width. Faces are antipodal: the rays that end where a pad will touch hit the surface
// within 25 degrees of the closing direction. Closing directions are taken in the object's own
// frame, so that flat faces are hit exactly.
#pragma once

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/forward.h"
#include "robocell/robot/robot.h"

namespace robocell {

struct GraspCandidate {
  Pose tcp_in_world;
  double width = 0;  // object width between the pads, metres
  // Distance of the object from a pad that does not move, to which the other one pushes it, metres.
  double aside = 0;
  double cost = 0;     // lower is better
  double opening = 0;  // free distance of the fingers during the approach, m; 0: fully open
  // The way of the hand to the grasp: a unit vector in the world.
  Eigen::Vector3d approach = -Eigen::Vector3d::UnitZ();
};

// Returns the candidates, best first; empty when the object is too large, too small or too flat for
// this gripper. The object is taken to stand on the height of its lowest point. Grasps that need
// less turning from `tcp_now` are preferred. Poses in `data` must be up to date.
std::vector<GraspCandidate> FindGrasps(const mjModel* model, const mjData* data, int object_body,
                                       const GripperShape& shape, const Pose& tcp_now);

// Returns candidates from all directions, best first, for objects that cannot be grasped straight
// from above: the sides of a tall bottle, the rim of a bowl (grasp_generator.h). They follow from the
// geometry alone, without registered libraries, so that picks are the same in every process. They are
// remembered in the process for each object and hand, and are empty for suction grippers.
std::vector<GraspCandidate> FindOtherGrasps(const Robot& robot, const std::string& object_body,
                                            const GripperShape& shape, const Pose& tcp_now);

// The widths of objects that a gripper can hold, computed from the distances of its fingers
// (metres): wider than the closed gripper, and with clearance on both sides in the open one.
struct HeldWidths {
  double least, most;
};
HeldWidths WidthsHeld(double closed_gap, double open_gap);
// Returns how far an object of this width has to be from the middle of the pads, along the closing
// direction, so that it is clear of both pads of the open hand, m: 0 if both open.
double AsideFor(const GripperShape& shape, double width);
// Returns "holds from 0.007 to 0.078 m", or, for a gripper that opens too little, why it holds
// nothing.
std::string DescribeHeldWidths(double closed_gap, double open_gap);

// Describes the sizes of an object without a candidate and of the gripper: "it is 0.30 m wide where
// it is narrowest and 0.30 m high, and the gripper holds from 0.007 to 0.078 m".
std::string SizesForGrasp(const mjModel* model, const mjData* data, int object_body,
                          const GripperShape& shape);

}  // namespace robocell
