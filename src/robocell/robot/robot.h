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
// targets), which the scene keeps as long as any handle to it or to one of its robots lives. Each
// call of FromScene() makes a separate robot, which lives as long as its handles. A reset hook of
// the scene, or a group of your own, that holds a handle keeps everything alive until
// Scene::Close().
//
// An arm is driven once, however many robots are made of it: robots from Of() or FromScene() whose
// arm has the same joints and actuators share its controller, mode and command ports. Making
// another one changes none of these. The mode belongs to the actuators: it stays when the last such
// robot is destroyed, and the next one holds the arm in its position, in that mode. An arm with
// some of these actuators and others gets no controller beside it: the first one drives them.
//
// Frames: the robot base frame is that of the root body. Joint values are in chain order, rad or m.
//
// Errors: NotFoundError for unknown names and for parts that the robot lacks, ArgumentError for
// wrong sizes and values that are not finite; after the scene was closed ClosedError, except from
// name(), prefix() and scene(). Threads: those of the scene.
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
  // Returns a robot by its name in the scene, with the groups of its configuration. Throws
  // NotFoundError that lists the robots.
  static Robot Of(const Scene& scene, const std::string& name);
  // Returns a robot without configuration: one arm group from the chain between two bodies.
  static Robot FromScene(const Scene& scene, const std::string& base_body,
                         const std::string& tip_body, const RobotOptions& options = {});

  const std::string& name() const;
  const std::string& prefix() const;
  // Returns the name that an element of the scene has in the robot's own model: without the prefix.
  std::string OwnName(const std::string& name) const;
  Scene scene() const { return scene_; }
  SceneUse& use() const { return scene_.use(); }  // use of the scene
  // Throws ClosedError after the scene was closed.
  void RequireOpen() const;
  const RobotConfig& config() const;

  // Groups by name, and the first of each kind. References, and spans of ports, stay valid until
  // the group is replaced, at most as long as a handle to this robot lives. Spans of command ports
  // also stay valid when the controller changes, unless it is of a custom kind with a port of its
  // own (Controller::UsePort). References to a controller are valid until any robot of the arm
  // replaces it; shared_group() and shared_controller() keep their result alive.
  std::vector<std::string> group_names() const;
  // Returns the number of groups, for loops that must not allocate.
  int group_count() const;
  bool has_group(const std::string& name) const;
  MoveGroup& group(const std::string& name) const;
  // Returns the same, and keeps the robot and the group alive, in use or not.
  std::shared_ptr<MoveGroup> shared_group(const std::string& name) const;
  MoveGroup& arm() const;
  // Returns the gripper of the first arm, see gripper_of().
  GripperGroup& gripper() const;
  bool has_gripper() const;
  bool has_arm() const;
  // Returns the name of an arm's gripper: the first one that hangs on the arm's last link, in the
  // order of the file; without such a gripper the first one that no other arm carries; "" for none.
  // Throws ArgumentError for a group that is not an arm.
  std::string gripper_of(const std::string& arm) const;
  BaseGroup& base() const;
  // Replaces or adds a group, e.g. one of a custom kind. It gets a new controller: joint
  // position, or none if its actuators are not position servos. A replaced group is destroyed when
  // no other owner keeps it.
  void SetGroup(std::shared_ptr<MoveGroup> group);

  // Returns true if the group has a controller, which Update() runs.
  bool is_driven(const std::string& group) const;
  // Throws NotFoundError with the reason if the group has none.
  Controller& controller(const std::string& group) const;
  // Returns the same, and keeps the robot, the group and the controller alive, in use or not.
  std::shared_ptr<Controller> shared_controller(const std::string& group) const;
  void SetController(const std::string& group, std::unique_ptr<Controller> controller);
  // Installs a controller by the name of its kind (controller.h).
  void SetController(const std::string& group, const std::string& kind);
  // Installs a controller by its class, whose `kKind` is its name, and returns it. Throws
  // ArgumentError if that name makes another class for this group.
  //   robot.SetController<CartesianImpedanceController>("arm").SetPose(pose);
  template <class T>
  T& SetController(const std::string& group) {
    std::unique_ptr<Controller> made = NewController(group, std::string(T::kKind));
    T* const known = dynamic_cast<T*>(made.get());
    if (!known) ThrowOtherClass(group, *made);
    SetController(group, std::move(made));
    return *known;
  }
  // Returns the mode that drives the arm. Setting it installs the port's controller
  // (joint_position, joint_velocity, joint_torque) unless it is already installed. Forces do not
  // jump: torques start with those that hold the arm against gravity, servos start with the forces
  // of the motors. Takes effect at once. Throws ArgumentError for a mode that the arm does not have
  // (RobotSpec::control_modes), and Error on a frozen model.
  CtrlMode ctrl_mode() const;
  void set_ctrl_mode(CtrlMode mode);
  // Returns a group's actuators of a mode, for making a controller for them. Throws ArgumentError
  // if there are none.
  MoveGroup& drive(const std::string& group, CtrlMode mode) const;
  // Returns the groups of this robot if this handle alone keeps them alive, as for a robot of a
  // closed scene; otherwise the scene owns them. For garbage collectors of other languages.
  std::vector<std::shared_ptr<MoveGroup>> groups_of_sole_handle() const;

  // Sets targets of the named groups; the others hold. A rejected action changes nothing. Pose
  // commands go through IK from the present target; a failed IK leaves that group's target and is
  // reported.
  struct ApplyResult {
    bool ok = true;
    std::string failed_group = {};  // the first one
    IkResult ik = {};               // its result
  };
  ApplyResult Apply(const RobotAction& action);
  // Reads the state and runs every controller once. Call Step() next to step the whole scene.
  void Update();
  StepResult Step() { return StepN(1); }
  StepResult StepN(int n);
  // While it is true, Step() and StepN() of this robot leave the scene unchanged; those of the
  // scene and of its other robots still work, and so does Update(). It stays through resets and
  // rebuilds.
  bool paused() const;
  void set_paused(bool paused);

  // Ports of the arm, in chain order. Update() reads `msr`; `trq_msr` is the force of its
  // actuators. `cmd` is the arm's command, for writing in place, one port for each mode that it
  // has. Throws ArgumentError for other modes, and Error if the controller of a mode takes other
  // numbers.
  // Only the port of the present mode drives. A value written into another port counts when its
  // mode is switched on; without one, the arm continues without a jump. A reset and SetJointPos()
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

  // Kinematics of the arm, from the root body (robot base frame) to the TCP. A reset or
  // Scene::Forward() updates it if the model was written to; a copy does not change.
  const Chain& chain() const;
  const Chain& chain(const std::string& group) const;  // chain of another arm
  Pose FkFrame() const;                                // TCP in the robot base frame, present state
  Pose FkFrame(std::span<const double> q) const;
  // Starts at `options.seed`, else at the present joint positions.
  IkResult Ik(const Pose& tcp_in_robot_base, IkOptions options = {}) const;
  // Returns the joints of these groups for IkOptions::locked. Joints outside the arm's chain do not
  // move in inverse kinematics anyway. Throws NotFoundError for an unknown group.
  LockedJoints LockGroups(std::span<const std::string> groups) const;
  Pose base_in_world() const;  // the robot base frame
  Pose tcp_in_world() const;
  // The TCP is the arm's leaf. If the leaf is a site, it is a separate tool frame: then
  // tcp_site() is the site's full name, else "". tip_to_tcp() is its pose in the tip body, which is
  // the last one that the arm moves or the one given to FromScene().
  bool has_tcp_frame() const { return !tcp_site().empty(); }
  const std::string& tcp_site() const;
  Pose tip_to_tcp() const;
  // Computes torques that hold the arm against gravity: the scene's, or one along the world's z
  // axis, m/s^2. Bodies with gravcomp count less. The scene's gravity is zero if its options
  // disable it.
  void GravityTorques(std::span<double> out, std::optional<double> gravity_z = {}) const;
  // Returns the scene's gravity (or one along the world's z axis) in the axes of the robot base
  // frame, for the dynamics of chain(), m/s^2.
  Eigen::Vector3d gravity_in_base(std::optional<double> gravity_z = {}) const;
  // The chains weigh the attached bodies (gripper, tool) at the model's reference. This uses their
  // present positions, for example of a closed gripper, until the next reset.
  void RefreshToolInertia();
  // Force-torque sensors: those of the configuration, or of the ToolFrameSpec. The reading is that
  // of Update() or of the end of a reset: the load on the sensor (ft_sensor.h defines its
  // direction), less the tare. Throws NotFoundError that lists the sensors.
  std::vector<std::string> ft_sensor_names() const;
  Wrench ft_sensor(const std::string& name) const;
  Pose ft_sensor_frame(const std::string& name) const;  // frame of the reading in the world
  // Subtracts the present reading, of the last step or Forward(), from later readings until the
  // next reset.
  void TareFtSensor(const std::string& name);
  // Returns the largest distance of the TCP from the root body, metres: configured, else measured
  // once.
  double reach() const;

  // Return the bodies and geoms of this robot (ids in the present model): its subtree with
  // attachments and pedestal.
  const std::vector<int>& body_ids() const;
  const std::vector<int>& geom_ids() const;
  // Returns the geoms that represent the robot in collision checks: the configuration's
  // `collision_geoms` and the pedestal, or all without that field.
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

// Returns the groups of all robots that a scene keeps, for garbage collectors too.
std::vector<std::shared_ptr<MoveGroup>> GroupsKeptBy(const Scene& scene);

// Returns all robots of a scene that have a configuration, in order.
std::vector<Robot> RobotsOf(const Scene& scene);

}  // namespace robocell
