// RobotConfig: what a robot is, reusable in any scene and usually a YAML file. See docs/robots.md.
//
//   name: xarm7
//   model: menagerie:ufactory_xarm7/xarm7.xml
//   root_body: link_base
//   base: {kind: mocap, size: [0.25, 0.25, 0.25]}
//   move_groups:
//     arm:     {kind: arm, joints: joint1..joint7, actuators: act1..act7, leaf: {site: link_tcp}}
//     gripper: {kind: gripper, joints: [left_driver_joint, right_driver_joint], actuators: gripper,
//               leaf: {site: link_tcp}, fingers: [left_finger_pad_2, right_finger_pad_2], ctrl:
//               {open: 0, closed: 255}}
//
// A hand with many joints has named poses in place of `ctrl`:
//
//     hand: {kind: gripper, actuators: [thumb, index], fingers: [thumb_tip, index_tip], poses:
//            {open: {thumb: 0, index: 0}, closed: {thumb: 1, index: 1.2}, pinch: {thumb: 0.9}}}
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/attachment_spec.h"
#include "robocell/spec/camera_spec.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/ctrl_mode.h"
#include "robocell/spec/edit.h"
#include "robocell/spec/element_ref.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/task_space.h"
#include "robocell/spec/tool_frame_spec.h"
#include "robocell/spec/types.h"

namespace robocell {

enum class BaseKind { kFixed, kMocap, kFree, kPlanar, kDriven };
template <>
struct EnumNames<BaseKind> {
  static constexpr std::array kNames = {
      std::pair{BaseKind::kFixed, "fixed"}, std::pair{BaseKind::kMocap, "mocap"},
      std::pair{BaseKind::kFree, "free"}, std::pair{BaseKind::kPlanar, "planar"},
      std::pair{BaseKind::kDriven, "driven"}};
};

enum class MoveGroupKind { kArm, kGripper, kBase, kGeneric };
template <>
struct EnumNames<MoveGroupKind> {
  static constexpr std::array kNames = {
      std::pair{MoveGroupKind::kArm, "arm"}, std::pair{MoveGroupKind::kGripper, "gripper"},
      std::pair{MoveGroupKind::kBase, "base"}, std::pair{MoveGroupKind::kGeneric, "generic"}};
};

// The default controller of a group.
enum class ControlKind {
  kJointPosition,
  kRelativeJointPosition,
  kJointVelocity,
  kJointTorque,
  kJointImpedance,
  kCartesianPose,
  kCartesianImpedance
};
template <>
struct EnumNames<ControlKind> {
  static constexpr std::array kNames = {
      std::pair{ControlKind::kJointPosition, "joint_position"},
      std::pair{ControlKind::kRelativeJointPosition, "relative_joint_position"},
      std::pair{ControlKind::kJointVelocity, "joint_velocity"},
      std::pair{ControlKind::kJointTorque, "joint_torque"},
      std::pair{ControlKind::kJointImpedance, "joint_impedance"},
      std::pair{ControlKind::kCartesianPose, "cartesian_pose"},
      std::pair{ControlKind::kCartesianImpedance, "cartesian_impedance"}};
};

// Returns the actuators that a controller uses.
CtrlMode ModeOf(ControlKind kind);

struct BaseConfig {
  BaseKind kind = BaseKind::kFixed;
  std::optional<Vec3> size = {};
  std::optional<double> max_linear_speed = {};
  std::optional<double> max_angular_speed = {};

  static constexpr const char* kTypeName = "BaseConfig";
  template <class V>
  static void Fields(V&& v) {
    v("kind", &BaseConfig::kind,
      "fixed, mocap (can be teleported), free, planar, or driven (follows a target and carries "
      "what "
      "the gripper holds).");
    v("size", &BaseConfig::size, "Length, width and height of a box under the robot, metres.",
      Bound::kPositive);
    v("max_linear_speed", &BaseConfig::max_linear_speed,
      "Driven: largest speed of the base, m/s. Unset: 0.5.", Bound::kPositive);
    v("max_angular_speed", &BaseConfig::max_angular_speed,
      "Driven: largest angular speed of the base, rad/s. Unset: 2.", Bound::kPositive);
  }
  void Validate(Problems& problems) const;
};

// The raw control values of a gripper's actuator.
struct GripperCtrl {
  double open = 0;
  double closed = 0;

  static constexpr const char* kTypeName = "GripperCtrl";
  template <class V>
  static void Fields(V&& v) {
    v("open", &GripperCtrl::open, "Control value that opens the gripper.");
    v("closed", &GripperCtrl::closed, "Control value that closes the gripper.");
  }
};

// The positions of a gripper's first joint at the ends of its travel, metres or radians.
struct GripperJointRange {
  double open = 0;
  double closed = 0;

  static constexpr const char* kTypeName = "GripperJointRange";
  template <class V>
  static void Fields(V&& v) {
    v("open", &GripperJointRange::open, "Joint value of the open gripper, m or rad.");
    v("closed", &GripperJointRange::closed, "Joint value of the closed gripper, m or rad.");
  }
};

// The free distance between the fingers, metres.
struct GripperDistance {
  double closed = 0;
  double open = 0;

  static constexpr const char* kTypeName = "GripperDistance";
  template <class V>
  static void Fields(V&& v) {
    v("closed", &GripperDistance::closed,
      "Distance of the fingers closed without an object, metres.", Bound::kNonNegative);
    v("open", &GripperDistance::open, "Distance of the open fingers, metres.", Bound::kPositive);
  }
};

struct MoveGroupConfig {
  MoveGroupKind kind = MoveGroupKind::kGeneric;
  NameList joints = {};
  NameList actuators = {};
  std::optional<ElementRef> root = {};
  std::optional<ElementRef> leaf = {};
  std::vector<ElementRef> fingers = {};
  Maybe<GripperCtrl> ctrl = {};
  Maybe<GripperDistance> distance = {};
  Maybe<GripperJointRange> joint_range = {};
  // Of hands with many joints: values of actuators and joints by their names.
  Map<Map<double>> poses = {};
  std::optional<std::string> closing_pose = {};
  Maybe<TaskSpaceConfig> task_space = {};

  // The names that `poses` needs: the open hand, and the closed one unless `closing_pose` is set.
  static constexpr const char* kOpenPose = "open";
  static constexpr const char* kClosedPose = "closed";
  std::string closing_pose_name() const { return closing_pose.value_or(kClosedPose); }

  static constexpr const char* kTypeName = "MoveGroupConfig";
  template <class V>
  static void Fields(V&& v) {
    v("kind", &MoveGroupConfig::kind, "arm, gripper, base or generic.");
    v("joints", &MoveGroupConfig::joints,
      "Joint names in chain order: a list, one name, or joint1..joint7.");
    v("actuators", &MoveGroupConfig::actuators,
      "Actuator names; for an arm one per joint in the same order.");
    v("root", &MoveGroupConfig::root,
      "Frame of the group's poses (body or site). Unset: the robot's root body, and of a gripper "
      "the leaf.");
    v("leaf", &MoveGroupConfig::leaf, "Frame that the group moves (body or site): an arm's TCP.");
    v("fingers", &MoveGroupConfig::fingers, "Gripper: the two finger geoms, bodies or sites.");
    v("ctrl", &MoveGroupConfig::ctrl,
      "Gripper: raw control values when open and closed. Unset: the actuator's range.");
    v("distance", &MoveGroupConfig::distance,
      "Gripper: finger distance when closed and open. Unset: measured.");
    v("joint_range", &MoveGroupConfig::joint_range,
      "Gripper: values of its first joint when open and closed, to read the opening from this "
      "joint. Unset: the opening is read from the distance between the fingers.");
    v("poses", &MoveGroupConfig::poses,
      "Gripper: named poses of the hand, `open` and `closed` among them; each maps actuators to "
      "controls, or joints with a position servo to positions. The opening goes between two of "
      "them.");
    v("closing_pose", &MoveGroupConfig::closing_pose,
      "Gripper with `poses`: the one that an opening of 0 takes. Unset: closed.");
    v("task_space", &MoveGroupConfig::task_space,
      "Arm: the part of a commanded pose that counts. Unset: all of it; with fewer than six "
      "degrees of freedom the position, and the nearest rotation.");
  }
  void Validate(Problems& problems) const;
};

struct RobotConfig {
  std::string name = {};
  std::string model = {};
  List<Edit> edits = {};
  List<AttachmentSpec> attachments = {};
  std::string root_body = {};
  BaseConfig base = {};
  std::optional<bool> reset_root_pose = {};
  Map<MoveGroupConfig> move_groups = {};
  std::optional<std::string> attachment_site = {};
  std::optional<Pose> tcp_offset = {};
  Map<std::vector<double>> home = {};
  Map<std::vector<double>> home_noise = {};
  Map<ControlKind> control = {};
  std::vector<ElementRef> collision_geoms = {};
  std::vector<std::string> ignored_collision_geoms = {};
  double arrival_tolerance = 0.002;  // rad; see slide_arrival_tolerance() for slides
  // Returns metres: the displacement of a point 0.1 m from a hinge that turns by the tolerance.
  double slide_arrival_tolerance() const { return 0.1 * arrival_tolerance; }
  std::optional<double> reach = {};
  std::optional<bool> gravcomp = {};
  std::optional<double> stiffness = {};
  std::optional<double> damping = {};
  std::optional<double> force_limit = {};
  List<CameraSpec> cameras = {};
  List<ForceTorqueSensorSpec> ft_sensors = {};
  // Folder of the file, where relative model paths start. It is not a field, and neither are the
  // locations of values, because they are not properties of the robot.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "RobotConfig";
  template <class V>
  static void Fields(V&& v) {
    v("name", &RobotConfig::name, "Name of this kind of robot.");
    v("model", &RobotConfig::model,
      "Model file: path (relative to this file), `menagerie:dir/file.xml` or built-in name.");
    v("edits", &RobotConfig::edits, "Small changes applied while the model is loaded.");
    v("attachments", &RobotConfig::attachments, "Tools that belong to this robot.");
    v("root_body", &RobotConfig::root_body,
      "The arm's root body; its frame is the robot base frame. Default: the model's only root.");
    v("base", &RobotConfig::base, "Base that the robot stands on.");
    v("reset_root_pose", &RobotConfig::reset_root_pose,
      "Drop the pose that the model file gives its root (true) or keep it (false). Unset: "
      "environments drop it; elsewhere robocell keeps it, but on a pedestal only its height and "
      "rotation, so that the robot stands in the middle.");
    v("move_groups", &RobotConfig::move_groups, "Named groups of joints.");
    v("attachment_site", &RobotConfig::attachment_site, "Site to which tools are attached.");
    v("tcp_offset", &RobotConfig::tcp_offset, "TCP relative to the attachment site.");
    v("home", &RobotConfig::home, "Joint positions per group at reset, rad or m.");
    v("home_noise", &RobotConfig::home_noise,
      "Uniform +- noise on home per group, one number or one per joint.", Bound::kNonNegative);
    v("control", &RobotConfig::control, "Default controller per group.");
    v("collision_geoms", &RobotConfig::collision_geoms,
      "Geoms that represent the robot in placement and planning. Unset: all. Of a gripper in an "
      "environment: geoms whose contacts are collisions. Unset: none.");
    v("ignored_collision_geoms", &RobotConfig::ignored_collision_geoms,
      "Environments: geoms of the scene, by their full names, that this robot or gripper may "
      "touch without a collision.");
    v("arrival_tolerance", &RobotConfig::arrival_tolerance,
      "Largest error of a motion that has arrived and is at rest, rad; of slides a tenth of it in "
      "m (0.002: 0.2 mm).",
      Bound::kPositive);
    v("reach", &RobotConfig::reach,
      "Largest distance of the TCP from the root body, metres. Unset: measured.", Bound::kPositive);
    v("gravcomp", &RobotConfig::gravcomp, "Compensate gravity on every body of the robot.");
    v("stiffness", &RobotConfig::stiffness, "Position gain of all arm servos.", Bound::kPositive);
    v("damping", &RobotConfig::damping, "Velocity gain of all arm servos.", Bound::kNonNegative);
    v("force_limit", &RobotConfig::force_limit, "Force limit of all arm servos, N or Nm.",
      Bound::kPositive);
    v("cameras", &RobotConfig::cameras, "Cameras that belong to the robot.");
    v("ft_sensors", &RobotConfig::ft_sensors, "Force-torque sensors of the robot.");
  }
  void Validate(Problems& problems) const;

  // Returns the modes that its `control` needs, including position: a scene declares these if its
  // robots do not switch modes (RobotSpec::control_modes).
  std::vector<CtrlMode> used_modes() const;

  // Reads a robot file. Throws SpecError with all problems and their file:line:column.
  static RobotConfig Load(const std::string& path);
};

}  // namespace robocell
