// Robot: a robot of a scene: its move groups, kinematics and controllers. A handle, cheap to copy.
// It follows resets and rebuilds of its scene (names stay, ids are looked up again).
//
//   Robot robot = Robot::Of(scene, "xarm7");             // groups from its RobotConfig
//   robot.Apply({{"arm", GroupCommand::Joints(q)}, {"gripper", GroupCommand::Opening(1)}});
//   for (int i = 0; i < 33; ++i) { robot.Update(); scene.Step(); }
//
//   Robot arm = Robot::FromScene(scene, "base_link", "bracelet_link",
//                                {.tool = {.tool_body = "g_base", .tcp_site = "g_pinch"}});
//   arm.Update();  arm.jnt_pos_cmd()[3] += 0.1;  arm.Step();
//
// Update() is the one path from commands to the engine: it reads the state into the ports and runs
// every group's controller once. No allocation.
//
// Lifetime: all handles from Of() to one robot of one scene share their state (groups, controllers,
// targets), which the scene keeps as long as any handle to it or to one of its robots lives.
// FromScene() makes a robot of its own each time, which lives as long as its handles. A reset hook
// of the scene, or a group of your own, that holds a handle keeps all alive until Scene::Close().
//
// An arm is driven once, however many robots are made of it: those whose arm has the same joints
// and actuators, from Of() or FromScene(), share its controller, mode and command ports. Making one
// changes nothing of these. The mode is the actuators': it stays when the last of them goes, and
// the next holds the arm where it is, in that mode. An arm that has some of these actuators and
// others has no controller beside it: whoever is there first drives them.
//
// Frames: the robot base frame is the root body's. Joint values in chain order, rad or m.
//
// Errors: NotFoundError for names and for what the robot does not have, ArgumentError for sizes and
// values that are not finite; after the scene was closed ClosedError for all but name(), prefix()
// and scene(). Threads: those of the scene.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"
#include "robocell/math/twist.h"
#include "robocell/robot/action.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"

namespace robocell {

struct RobotOptions {
  std::string prefix = {};
  ToolFrameSpec tool = {};
};

class Robot {
 public:
  // A robot by its name in the scene, with the groups of its configuration. NotFoundError lists the
  // robots.
  static Robot Of(const Scene& scene, const std::string& name);
  // A robot without configuration: one arm group from the chain between two bodies.
  static Robot FromScene(const Scene& scene, const std::string& base_body,
                         const std::string& tip_body, const RobotOptions& options = {});

  const std::string& name() const;
  const std::string& prefix() const;
  Scene scene() const { return scene_; }
  SceneUse& use() const { return scene_.use(); }  // of the scene
  // ClosedError after the scene was closed.
  void RequireOpen() const;
  const RobotConfig& config() const;

  // Groups by name, and the first of each kind. References, and spans of ports, stay valid until
  // the group is replaced, at most as long as a handle to this robot lives; spans of command ports
  // through changes of the controller too, unless it is of a kind of your own that keeps a port of
  // its own (Controller::UsePort). References to controllers are valid until that is replaced, by
  // any robot that has the arm; shared_group() and shared_controller() keep what they return.
  std::vector<std::string> group_names() const;
  // How many there are, without their names: for loops that must not allocate.
  int group_count() const;
  bool has_group(const std::string& name) const;
  MoveGroup& group(const std::string& name) const;
  // The same, keeping the robot and the group alive, in use or not.
  std::shared_ptr<MoveGroup> shared_group(const std::string& name) const;
  MoveGroup& arm() const;
  // The gripper of the first arm, see gripper_of().
  GripperGroup& gripper() const;
  bool has_gripper() const;
  bool has_arm() const;
  // The name of the gripper that goes with an arm: the first that hangs on the arm's last link, in
  // the order of the file; where it carries none the first that no other arm carries; "" for none.
  // ArgumentError for a group that is no arm.
  std::string gripper_of(const std::string& arm) const;
  BaseGroup& base() const;
  // Replaces or adds a group, e.g. the user's own kind. Its controller is made anew: joint
  // position, or none when its actuators are no position servos. What was replaced goes when
  // nobody else keeps it.
  void SetGroup(std::shared_ptr<MoveGroup> group);

  // Returns true if the group has a controller, which Update() runs.
  bool is_driven(const std::string& group) const;
  // NotFoundError says why a group has none.
  Controller& controller(const std::string& group) const;
  // The same, keeping the robot, the group and the controller alive, in use or not.
  std::shared_ptr<Controller> shared_controller(const std::string& group) const;
  void SetController(const std::string& group, std::unique_ptr<Controller> controller);
  // By the name of its kind (controller.h).
  void SetController(const std::string& group, const std::string& kind);
  // The kind by its class, whose `kKind` is its name; returns what was put in. ArgumentError when
  // that name makes another class for this group.
  //   robot.SetController<CartesianImpedanceController>("arm").SetPose(pose);
  template <class T>
  T& SetController(const std::string& group) {
    std::unique_ptr<Controller> made = NewController(group, std::string(T::kKind));
    T* const known = dynamic_cast<T*>(made.get());
    if (!known) ThrowOtherClass(group, *made);
    SetController(group, std::move(made));
    return *known;
  }
  // The mode that drives the arm. Setting it installs the port's controller (joint_position,
  // joint_velocity, joint_torque) unless it is there. Forces do not jump: torques start with those
  // that hold the arm against gravity, servos push as the motors did. Takes effect at once.
  // ArgumentError for a mode that the arm does not have (RobotSpec::control_modes), Error on a
  // frozen model.
  CtrlMode ctrl_mode() const;
  void set_ctrl_mode(CtrlMode mode);
  // A group's actuators of a mode, for making a controller for them; ArgumentError without.
  MoveGroup& drive(const std::string& group, CtrlMode mode) const;
  // For garbage collectors of other languages: the groups of this robot when this handle alone
  // keeps them alive, as of a robot whose scene was closed; else they are the scene's.
  std::vector<std::shared_ptr<MoveGroup>> groups_of_sole_handle() const;

  // Sets targets of the groups named; the others hold. An action that is refused changes nothing.
  // Pose commands go through IK from the present target; a failed IK leaves that group's target and
  // is reported.
  struct ApplyResult {
    bool ok = true;
    std::string failed_group = {};  // the first one
    IkResult ik = {};               // its
  };
  ApplyResult Apply(const RobotAction& action);
  // Reads the state and runs every controller once. Then Step() steps the whole scene.
  void Update();
  StepResult Step() { return StepN(1); }
  StepResult StepN(int n);
  // While it is true, Step() and StepN() of this robot leave the scene as it is; those of the scene
  // and of its other robots go on. Update() goes on too. It stays through resets and rebuilds.
  bool paused() const;
  void set_paused(bool paused);

  // Ports of the arm, in chain order. `msr` are what Update() read; `trq_msr` is what its actuators
  // apply. `cmd` is what the arm is driven to, for writing in place, one port for each mode that it
  // has; ArgumentError for others, Error where a controller of that mode takes something else.
  // Only the port of the present mode drives. What is written into another one counts when its mode
  // is switched to; where nothing was, the arm goes on without a jump. A reset and SetJointPos()
  // forget it.
  int n_joints() const;
  const std::vector<std::string>& joint_names() const;
  std::vector<Interval> joint_limits() const;
  std::span<const double> jnt_pos_msr() const;
  std::span<const double> jnt_vel_msr() const;
  std::span<const double> jnt_trq_msr() const;
  std::span<double> jnt_pos_cmd() const;
  void SetJntPosCmd(std::span<const double> q);
  std::span<double> jnt_vel_cmd() const;
  void SetJntVelCmd(std::span<const double> velocity);
  std::span<double> jnt_trq_cmd() const;
  void SetJntTrqCmd(std::span<const double> torque);
  // Teleports the arm, resets its port, lets its actuators hold it there and updates the poses.
  // Velocities stay. Positions beyond the limits are accepted, because the limits are soft and push
  // back; this is logged once. Without `call_forward` poses are updated on demand, and everything
  // else by the next step.
  void SetJointPos(std::span<const double> q, bool call_forward = true);

  // Kinematics of the arm: from the root body (robot base frame) to the TCP. Made anew by a reset
  // or Scene::Forward() that finds the model written to; a copy stays what it is.
  const Chain& chain() const;
  const Chain& chain(const std::string& group) const;  // of another arm
  Pose FkFrame() const;                                // TCP in the robot base frame, present state
  Pose FkFrame(std::span<const double> q) const;
  // Starts at `options.seed`, else at the present joint positions.
  IkResult Ik(const Pose& tcp_in_robot_base, IkOptions options = {}) const;
  // For IkOptions::locked: the joints of these groups. Those outside the arm's chain stand still in
  // inverse kinematics anyway. NotFoundError for an unknown group.
  LockedJoints LockGroups(std::span<const std::string> groups) const;
  Pose base_in_world() const;  // the robot base frame
  Pose tcp_in_world() const;
  // The TCP is the arm's leaf. It is a tool frame of its own when that is a site: then tcp_site()
  // is the site's full name, else "". tip_to_tcp() is its pose in the tip body, which is the last
  // one that the arm moves or the one given to FromScene().
  bool has_tcp_frame() const { return !tcp_site().empty(); }
  const std::string& tcp_site() const;
  Pose tip_to_tcp() const;
  // Torques that hold the arm against gravity: the scene's, or one along the world's z axis, m/s^2.
  // Bodies with gravcomp count less. The scene's is zero where its options disable it.
  void GravityTorques(std::span<double> out, std::optional<double> gravity_z = {}) const;
  // The scene's gravity (or one along the world's z axis) in the axes of the robot base frame, for
  // the dynamics of chain(), m/s^2.
  Eigen::Vector3d gravity_in_base(std::optional<double> gravity_z = {}) const;
  // The chains weigh what hangs on them (gripper, tool) where it is at the model's reference. This
  // takes it where it is now, as of a gripper that has closed, until the next reset.
  void RefreshToolInertia();
  // Force-torque sensors: those of the configuration, or of the ToolFrameSpec. The reading is what
  // Update() or the end of a reset read: the load on the sensor (ft_sensor.h says which way it
  // points), less what tare took off. NotFoundError lists the sensors.
  std::vector<std::string> ft_sensor_names() const;
  Wrench ft_sensor(const std::string& name) const;
  Pose ft_sensor_frame(const std::string& name) const;  // of the reading, in the world
  // Subtracts the present reading, of the last step or Forward(), from later readings until the
  // next reset.
  void TareFtSensor(const std::string& name);
  // Farthest the TCP gets from the root body, metres: configured, else measured once.
  double reach() const;

  // Bodies and geoms of this robot (ids in the present model): its subtree with attachments and
  // pedestal.
  const std::vector<int>& body_ids() const;
  const std::vector<int>& geom_ids() const;
  // Geoms that represent the robot in collision checks: the configuration's `collision_geoms` and
  // the pedestal, or all without that field.
  const std::vector<int>& collision_geom_ids() const;

 private:
  friend std::vector<std::shared_ptr<MoveGroup>> GroupsKeptBy(const Scene& scene);
  class State;
  State& open() const;
  std::unique_ptr<Controller> NewController(const std::string& group,
                                            const std::string& kind) const;
  [[noreturn]] void ThrowOtherClass(const std::string& group, const Controller& made) const;
  std::span<double> Port(TargetKind kind, const char* name, CtrlMode mode) const;
  void WritePort(TargetKind kind, std::span<double> port, std::span<const double> values);
  Robot(Scene scene, std::shared_ptr<State> state)
      : scene_(std::move(scene)), state_(std::move(state)) {}
  Scene scene_;
  std::shared_ptr<State> state_;
};

// The groups of all robots that a scene keeps, for garbage collectors too.
std::vector<std::shared_ptr<MoveGroup>> GroupsKeptBy(const Scene& scene);

// All robots of a scene that have a configuration, in order.
std::vector<Robot> RobotsOf(const Scene& scene);

}  // namespace robocell
