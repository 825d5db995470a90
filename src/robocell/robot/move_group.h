// MoveGroup: a named set of joints and actuators that move together, with a root and a leaf frame.
// An interface: simply actuated groups (arms), grippers and bases are its kinds, and users may
// write their own, in C++ or Python.
//
// A group reads and writes the mjData of its scene. Joint values are in the order of joint_names(),
// radians or metres as in mjData.qpos; groups whose joints are not all one-dimensional (ball, free)
// have nq() != nv(). Frames are X_WT etc.; six-vectors have the linear rows first. After a rebuild
// of the scene a group finds its elements again by name.
//
//   MoveGroup& arm = robot.group("arm");
//   Pose tcp_in_world = arm.leaf_frame_to_world();
//   arm.SetJointPos(q);            // teleports and updates the poses
//   arm.SetCtrl(ctrl);             // raw actuator values
//
// Errors: ArgumentError for a wrong number of values ("group 'arm': expected 7 joint values, got
// 3"), ClosedError after the scene was closed. Threads: those of the scene.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/spec/robot_config.h"

namespace robocell {

class Scene;

struct Interval {
  double lower, upper;
};

class MoveGroup {
 public:
  virtual ~MoveGroup() = default;

  virtual const std::string& name() const = 0;  // name as in RobotConfig.move_groups
  // Returns the place for messages: "robot 'left' / group 'arm'", or without an unknown robot.
  virtual std::string place() const { return "group '" + name() + "'"; }
  // Throws ClosedError if its scene was closed. A group without a scene is never closed.
  virtual void RequireOpen() const {}
  // Returns its scene; null for a group without one.
  virtual const Scene* scene() const { return nullptr; }
  virtual MoveGroupKind kind() const = 0;

  // Sizes and names (full names in the model).
  virtual int nq() const = 0;
  virtual int nv() const = 0;
  virtual int nu() const = 0;
  virtual const std::vector<std::string>& joint_names() const = 0;
  virtual const std::vector<std::string>& actuator_names() const = 0;

  // State. `out` has nq(), nv(), nv() and nu() entries.
  virtual void GetJointPos(std::span<double> out) const = 0;
  virtual void GetJointVel(std::span<double> out) const = 0;
  virtual void GetJointTorque(std::span<double> out) const = 0;  // forces of the actuators, N or Nm
  virtual void GetCtrl(std::span<double> out) const = 0;
  virtual void SetJointPos(std::span<const double> q) = 0;
  virtual void SetJointVel(std::span<const double> v) = 0;
  virtual void SetCtrl(std::span<const double> ctrl) = 0;  // rejects NaN by actuator name

  virtual std::vector<Interval> joint_pos_limits() const = 0;  // +-infinity without a limit
  virtual std::vector<Interval> ctrl_limits() const = 0;
  // Computes the control that keeps the group in its present position.
  virtual void NoopCtrl(std::span<double> out) const = 0;
  // Computes the controls whose servos rest at the joint positions `q`, within the control limits.
  // Throws ArgumentError if an actuator is not a position servo. No allocation.
  virtual void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const = 0;
  // Moves q by the velocity v (nv entries) for a unit of time.
  virtual void Integrate(std::span<double> q, std::span<const double> v) const = 0;

  // Frames.
  virtual Pose leaf_frame_to_world() const = 0;
  virtual Pose root_frame_to_world() const = 0;
  virtual Pose leaf_frame_to_robot() const = 0;  // pose in the robot base frame
  Pose leaf_frame_to_root() const {
    return root_frame_to_world().inverse() * leaf_frame_to_world();
  }
  // Writes the 6 x nv Jacobian of the leaf frame, in world axes, linear rows first.
  virtual void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const = 0;

  // Convenience functions that allocate.
  std::vector<double> joint_pos() const;
  std::vector<double> joint_vel() const;
  std::vector<double> joint_torque() const;
  std::vector<double> ctrl() const;
  std::vector<double> noop_ctrl() const;
};

// Returns joint_pos_limits() of a group in a checked form: one rising interval for each of its nq()
// positions. Throws ArgumentError with the group's place for anything else, which a user's own
// group may return: a missing limit would mean a joint without limits.
std::vector<Interval> CheckedJointPosLimits(const MoveGroup& group);

// A gripper: `opening` is 0 (closed) to 1 (open), independent of the raw control.
class GripperGroup : public MoveGroup {
 public:
  // Returns the measured opening, from the finger distance.
  virtual double opening() const = 0;
  // Commands the actuator; clamps to 0..1, rejects NaN. The robot's controller adopts it.
  virtual void SetOpening(double opening) = 0;
  void Open() { SetOpening(1); }
  void Close() { SetOpening(0); }
  // Returns the control of the first actuator; the others have the same unless CtrlForOpening
  // differs.
  virtual double ctrl_for_opening(double opening) const = 0;
  // Computes the control of each actuator (nu values).
  virtual void CtrlForOpening(double opening, std::span<double> ctrl) const;
  // Returns the names of the hand's poses (MoveGroupConfig::poses); usually none.
  virtual std::vector<std::string> pose_names() const { return {}; }
  // Returns the pose that an opening of 0 takes, one of pose_names(); "" for a gripper without.
  virtual std::string closing_pose() const { return ""; }
  // Closes towards another of the poses from now on, until the next reset; "" for the configured
  // one. The commanded opening stays. Throws NotFoundError, and ArgumentError for the open pose.
  virtual void SetClosingPose(const std::string& name);
  // Commands a pose: opens the hand for `open`; else makes it the closing pose, and closes.
  void MoveToPose(const std::string& name);
  // Returns the free distance between the fingers, metres; its range is {closed, open}, measured
  // once if not configured.
  virtual double inter_finger_dist() const = 0;
  virtual Interval inter_finger_dist_range() const = 0;
  virtual bool is_open() const = 0;
  // Returns true if both fingers touch `body` or parts of it (a full name); if empty, any one
  // movable body outside the robot. Contacts are those of the last step.
  virtual bool is_grasping(const std::string& body = "") const = 0;
};

// The largest speeds of a driven base, m/s and rad/s.
struct BaseSpeeds {
  double linear = 0.5, angular = 2;
  bool operator==(const BaseSpeeds&) const = default;
};

// The base that the robot stands on.
class BaseGroup : public MoveGroup {
 public:
  // Returns the pose of the pedestal's bottom, of the mocap, free, planar or driven body, or else
  // of the robot's root.
  virtual Pose pose() const = 0;
  // Puts the base there at once and stops it: a teleport, which does not carry an object that the
  // robot holds; that is logged. Throws ArgumentError for a fixed base, and for a pose outside a
  // planar base's plane.
  virtual void SetPose(const Pose& pose_in_world) = 0;
  // Returns true if the base can move by itself: free, planar and driven bases.
  virtual bool is_mobile() const = 0;

  // Returns true if the base moves to a target by itself, like BaseKind::kDriven. The functions
  // below throw ArgumentError for other bases.
  virtual bool is_driven() const { return false; }
  // Returns the target of the driven base. Robot::Update() moves the base there within
  // max_speeds(), together with an object that the robot holds. A reset and SetPose() set the
  // target to the pose of the base.
  virtual Pose target() const;
  virtual void SetTarget(const Pose& pose_in_world);
  // Returns the speeds; initially those of the robot's BaseConfig.
  virtual BaseSpeeds max_speeds() const;
  virtual void SetMaxSpeeds(const BaseSpeeds& speeds);  // must be above 0
};

}  // namespace robocell
