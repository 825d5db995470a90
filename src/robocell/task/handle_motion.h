// Paths of a hand that moves a joint of the surroundings: it grips the handle of a door, a drawer or
// a lid and follows its arc or line, or presses a button along its slide.
//
//   const std::vector<ContactPath> paths = HandlePaths(scene, opening, *shape, 0.5);
//   ContactMotions motions(planning, paths, home);   // contact_motion.h
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/contact_motion.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

// The part of a handle that fingers close on, in the world, as it is now.
struct HandleBar {
  Eigen::Vector3d middle, axis, outward;  // outward: away from what carries it
  double half_length = 0;                 // m
  // The half extents of its section along `across` and along the axis' cross product with it, m;
  // equal for a round bar.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  Eigen::Vector2d section = Eigen::Vector2d::Zero();
  bool is_round = true;
  bool is_exact = true;  // false: the box around a mesh

  // Returns its width along a direction across the axis, m.
  double WidthAlong(const Eigen::Vector3d& direction) const;
  // Returns the unit direction from the bar to a point.
  Eigen::Vector3d From(const Eigen::Vector3d& point) const;
};

// Returns the bar of the handle of a joint: the longest of the geoms named handle or knob
// (scenes/handle_geoms.h) that move as one with the joint's body, meshes last; unset without one.
std::optional<HandleBar> FindHandle(const Scene& scene, const JointOpening& opening);
// Returns true for a knob on its joint's own axis: it is turned, and opens nothing.
bool TurnsOnTheSpot(const Scene& scene, const JointOpening& opening);
// Returns the level direction in front of a joint's handle, or of a button that is pressed from the
// side; unset without one.
std::optional<Eigen::Vector3d> FrontOf(const Scene& scene, const JointOpening& opening);

// Returns the points through which the handle moves, or the middle of the button's face, from the
// present position of the joint to a share of its range: the first, some between, and the last.
// Empty for a joint with neither.
std::vector<Eigen::Vector3d> WayOfHandle(const Scene& scene, const JointOpening& opening,
                                         double share);

// How a hand takes a handle. kAcross: the fingers close on it; those on its sides come first, which
// have the most room, then those in front of it and behind it. kBehind: the hand stays open, and one
// finger comes behind the bar and moves it, whatever the force of the gripper is.
enum class HandleHold { kAcross, kBehind };

// Returns the paths of a hand that moves the joint by its handle from the present position to a share
// of its range, best first: along the bar, tilted about it, leaning along it, and turned with the
// door, half as far, or not at all. Empty without a handle that fits between the fingers.
std::vector<ContactPath> HandlePaths(const Scene& scene, const JointOpening& opening,
                                     const GripperShape& shape, double share,
                                     HandleHold hold = HandleHold::kAcross);
// The same with grasps that grasp_generator.h computes. Of fingers those of the handle, for handles
// that are meshes and for hands that no bar fits. Of cups those on the faces that move the joint.
std::vector<ContactPath> GraspedHandlePaths(const Robot& robot, const JointOpening& opening,
                                            const GripperShape& shape, double share);
// Returns the paths of the tip of a closed hand that pushes the joint's body, with its handle, to a
// share of the range: far from a hinge first. Empty for cups, and where no face looks against the
// motion.
std::vector<ContactPath> PushedJointPaths(const Robot& robot, const JointOpening& opening,
                                          const GripperShape& shape, double share);
// Returns the paths of a closed hand that is hooked behind the handle. Empty for cups, and for handles
// behind which there is no room.
std::vector<ContactPath> HookedJointPaths(const Robot& robot, const JointOpening& opening,
                                          const GripperShape& shape, double share);
// Returns the paths of a closed hand that presses the joint's body from its present position to the
// end of its range; empty for a hinge.
std::vector<ContactPath> PressPaths(const Scene& scene, const JointOpening& opening,
                                    const GripperShape& shape);

// Returns the share of the range to which an expert moves a joint for a relation: somewhat more than
// it requires.
double ShareFor(const StatedRelation& stated);
// Returns the paths that bring about a relation about a joint, one way of the hand after the other.
// What is to be closed is pushed, else gripped; what is to be opened is gripped. `failures`: how many
// times the hand has failed: after a failure the other ways come first. `shape` must outlive the
// source.
ContactPathSource JointPaths(const Robot& robot, const StatedRelation& stated,
                             const GripperShape& shape, int failures = 0);
// Returns why there are none, in few words: "no grasp of the handle", "no way to press it".
std::string WhyNoJointPaths(const StatedRelation& stated);
// Refuses a start in which the robot cannot follow any of these. Robots without a gripper that can
// be measured pass.
std::optional<Refusal> CheckJointGoal(const Scene& scene, const Robot& robot,
                                      const StatedRelation& stated);

// A path that is followed in part is of use: the hand grips again from there.
inline constexpr double kLeastFollowed = 0.35;

}  // namespace robocell::internal
