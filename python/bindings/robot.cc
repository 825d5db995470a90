// Robots, move groups and controllers.
#include <nanobind/nanobind.h>

#include "arrays.h"
#include "bindings.h"
#include "control.h"
#include "handles.h"
#include "kinematics.h"
#include "move_group_trampoline.h"
#include "python_owner.h"
#include "scene_cycles.h"
#include "signals.h"
#include "values.h"
#include "robocell/env/stepper.h"
#include "robocell/robot/robot.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

nb::object IntervalArray(const std::vector<Interval>& intervals) {
  std::vector<double> flat;
  for (const Interval& i : intervals) flat.insert(flat.end(), {i.lower, i.upper});
  return NewArray<double>(flat, {intervals.size(), 2});
}

nb::object GroupJacobian(const MoveGroup& group) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> j(6, group.nv());
  group.Jacobian(j);
  std::vector<double> flat;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < j.cols(); ++c) flat.push_back(j(r, c));
  }
  return NewArray<double>(flat, {6, static_cast<size_t>(j.cols())});
}

// Groups that Python gets from C++ (Robot::shared_group) have a handle to their robot.
int VisitMoveGroup(const MoveGroup& group, visitproc visit, void* arg) {
  const bool own = dynamic_cast<const WrittenInPython*>(&group) != nullptr;
  return own || !group.scene() ? 0 : VisitScene(*group.scene(), visit, arg);
}

int VisitRobot(const Robot& robot, visitproc visit, void* arg) {
  if (const int stop = VisitGroups(robot.groups_of_sole_handle(), visit, arg)) return stop;
  return VisitScene(robot.scene(), visit, arg);
}

int VisitStepper(const Stepper& stepper, visitproc visit, void* arg) {
  for (const Robot& robot : stepper.robots()) {
    if (const int stop = VisitScene(robot.scene(), visit, arg)) return stop;
  }
  return VisitScene(stepper.scene(), visit, arg);
}

void GuardGroup(nb::handle type) {
  GuardHandle<MoveGroup>(
      type, [](const MoveGroup& g, SceneClaims& claims) { claims.Add(g.scene()); },
      [](const MoveGroup& g) { g.RequireOpen(); }, {.always = {"name", "kind"}});
}

void BindGroups(nb::module_& m) {
  nb::class_<MoveGroup, PyMoveGroup> group(
      m, "MoveGroup",
      "A named set of joints and actuators that move together.\n\n"
      "To write your own, subclass it (or GripperGroup, BaseGroup) and define get_name, get_kind "
      "(default: generic), get_joint_names, get_actuator_names, get_joint_pos, get_joint_vel,\n"
      "get_joint_torque, get_ctrl, set_joint_pos, set_joint_vel, set_ctrl, get_noop_ctrl, "
      "ctrl_for_joint_pos,\n"
      "get_joint_pos_limits (nq, 2), get_ctrl_limits (nu, 2), get_leaf_frame_to_world, "
      "get_root_frame_to_world, get_leaf_frame_to_robot,\n"
      "get_jacobian (6, nv) and integrate as needed, each returning arrays of its shape; then "
      "robot.set_group(group). A gripper also defines get_opening, set_opening,\n"
      "ctrl_for_opening, get_inter_finger_dist, get_inter_finger_dist_range, get_is_open and "
      "get_is_grasping(body); a base\n"
      "get_pose, set_pose and get_is_mobile.",
      nb::type_slots(kHandleSlots<MoveGroup, &VisitMoveGroup, HandleIs::kShared>));
  group.def(nb::init<>())
      .def_prop_ro(
          "name", [](const MoveGroup& g) { return g.name(); }, "Name of the group in its robot.")
      .def_prop_ro(
          "kind", [](const MoveGroup& g) { return std::string(ToString(g.kind())); },
          "Kind of the group: \"arm\", \"gripper\", \"base\" or \"generic\".")
      .def_prop_ro(
          "nq", [](const MoveGroup& g) { return g.nq(); }, "Number of joint positions.")
      .def_prop_ro(
          "nv", [](const MoveGroup& g) { return g.nv(); }, "Number of joint velocities.")
      .def_prop_ro(
          "nu", [](const MoveGroup& g) { return g.nu(); }, "Number of actuator controls.")
      .def_prop_ro(
          "joint_names", [](const MoveGroup& g) { return g.joint_names(); },
          "Names of the joints in the model.")
      .def_prop_ro(
          "actuator_names", [](const MoveGroup& g) { return g.actuator_names(); },
          "Names of the actuators in the model.")
      .def_prop_rw(
          "joint_pos", [](const MoveGroup& g) { return NewArray(g.joint_pos()); },
          [](MoveGroup& g, nb::handle q) { g.SetJointPos(ToRow(q, "joint_pos")); },
          nb::for_getter(nb::sig("def joint_pos(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint positions (nq,), rad or m. Setting them teleports the joints alone: controls "
          "stay, "
          "so servos pull back to their targets. `Robot.set_joint_pos` takes an arm's commands "
          "with it."
          "\n\nExamples:\n"
          "    >>> robot.arm.joint_pos = [0, 0.25, 0, 1.65, 0, 1.24, 0]")
      .def_prop_rw(
          "joint_vel", [](const MoveGroup& g) { return NewArray(g.joint_vel()); },
          [](MoveGroup& g, nb::handle v) { g.SetJointVel(ToRow(v, "joint_vel")); },
          nb::for_getter(nb::sig("def joint_vel(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint velocities (nv,), rad/s or m/s.")
      .def_prop_ro(
          "joint_torque", [](const MoveGroup& g) { return NewArray(g.joint_torque()); },
          nb::for_getter(nb::sig("def joint_torque(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Torques of the actuators (nv,), Nm or N.")
      .def_prop_rw(
          "ctrl", [](const MoveGroup& g) { return NewArray(g.ctrl()); },
          [](MoveGroup& g, nb::handle c) { g.SetCtrl(ToRow(c, "ctrl")); },
          nb::for_getter(nb::sig("def ctrl(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Raw actuator controls (nu,).")
      .def_prop_ro(
          "noop_ctrl", [](const MoveGroup& g) { return NewArray(g.noop_ctrl()); },
          nb::for_getter(nb::sig("def noop_ctrl(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Returns the control (nu,) that holds the group where it is.")
      .def_prop_ro(
          "joint_pos_limits",
          [](const MoveGroup& g) { return IntervalArray(g.joint_pos_limits()); },
          nb::for_getter(
              nb::sig("def joint_pos_limits(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint limits (nq, 2); infinite for joints without limits.")
      .def_prop_ro(
          "ctrl_limits", [](const MoveGroup& g) { return IntervalArray(g.ctrl_limits()); },
          nb::for_getter(nb::sig("def ctrl_limits(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Limits of the controls (nu, 2).")
      .def_prop_ro("leaf_frame_to_world", &MoveGroup::leaf_frame_to_world,
                   "Pose of the leaf frame in the world: of an arm the TCP.")
      .def_prop_ro("root_frame_to_world", &MoveGroup::root_frame_to_world,
                   "Pose of the group's root frame in the world.")
      .def_prop_ro("leaf_frame_to_robot", &MoveGroup::leaf_frame_to_robot,
                   "Pose of the leaf frame in the robot base frame.")
      .def_prop_ro("leaf_frame_to_root", &MoveGroup::leaf_frame_to_root,
                   "Pose of the leaf frame in the group's root frame.")
      .def(
          "integrate",
          [](const MoveGroup& g, nb::handle q, nb::handle v) {
            std::vector<double> moved = ToRow(q, "q");
            g.Integrate(moved, ToRow(v, "v"));
            return NewArray(moved);
          },
          "q"_a, "v"_a,
          nb::sig("def integrate(self, q: numpy.typing.ArrayLike, v: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Returns the joint positions (nq,) after q (nq,) moved with the velocities v (nv,) for a "
          "unit of time: rad and rad/s, m and m/s; quaternions rotate and stay unit. Nothing moves "
          "in the scene. Raises ArgumentError for a wrong number of values.")
      .def("jacobian", &GroupJacobian,
           "Returns the Jacobian (6, nv) at the leaf frame, in world axes, linear rows first.");
  nb::class_<GripperGroup, MoveGroup, PyGripperGroup> gripper(
      m, "GripperGroup",
      "A gripper. Its opening is 0 (closed) to 1 (open), whatever the raw control means.");
  gripper.def(nb::init<>())
      .def_prop_rw(
          "opening",
          [](const GripperGroup& g) {
            const nb::gil_scoped_release unlocked;
            return g.opening();
          },
          [](GripperGroup& g, nb::handle opening) {
            const double value = ToDouble(opening, FieldPath("opening"));
            const nb::gil_scoped_release unlocked;
            g.SetOpening(value);
          },
          nb::for_setter(nb::arg("value").none()),
          nb::for_setter(nb::sig("def opening(self, value: float, /) -> None")),
          "Measured opening. Setting it commands the actuator, and the robot's update holds it. "
          "Values beyond 0 ... 1 are clipped, which is logged once."
          "\n\nExamples:\n"
          "    >>> robot.gripper.opening = 0.5")
      .def(
          "raw_ctrl", [](const GripperGroup& g, double o) { return g.ctrl_for_opening(o); },
          "opening"_a, Unlocked(),
          "Returns the raw control of the first actuator for an opening, 0 ... 1.")
      .def(
          "raw_ctrls",
          [](const GripperGroup& g, double o) {
            std::vector<double> ctrl(static_cast<size_t>(g.nu()));
            g.CtrlForOpening(o, ctrl);
            return ctrl;
          },
          "opening"_a, Unlocked(), "Returns the raw controls (nu,) for an opening, 0 ... 1.")
      .def("open", &GripperGroup::Open, Unlocked(),
           "Commands the gripper to open, as `opening = 1`.")
      .def("close", &GripperGroup::Close, Unlocked(),
           "Commands the gripper to close, as `opening = 0`.")
      .def_prop_ro("pose_names", &GripperGroup::pose_names,
                   "Names of the hand's poses, from `poses` of its group; usually none.")
      .def_prop_rw("closing_pose", &GripperGroup::closing_pose, &GripperGroup::SetClosingPose,
                   "Pose that an opening of 0 takes; '' for a gripper without poses. Setting it "
                   "lasts until the next reset; '' restores the configured one.")
      .def("move_to_pose", &GripperGroup::MoveToPose, "name"_a, Unlocked(),
           "Commands a named pose: opens the hand for 'open', else closes it towards that pose.")
      .def_prop_ro("inter_finger_dist", &GripperGroup::inter_finger_dist,
                   "Distance between the fingers, metres.")
      .def_prop_ro(
          "inter_finger_dist_range",
          [](const GripperGroup& g) {
            const Interval range = g.inter_finger_dist_range();
            return std::pair(range.lower, range.upper);
          },
          Unlocked(),
          "Finger distance (closed, open) in metres; measured once unless the robot's "
          "configuration gives it.")
      .def_prop_ro("is_open", &GripperGroup::is_open,
                   "True if the measured opening is at least 0.9.")
      .def("is_grasping", &GripperGroup::is_grasping, "body"_a = "",
           "Returns True if both fingers touch `body`, or any body that is not the robot's."
           "\n\nExamples:\n"
           "    >>> robot.gripper.is_grasping(\"cube\")\n"
           "    False");
  nb::class_<BaseGroup, MoveGroup, PyBaseGroup> base(m, "BaseGroup", "The base of a robot.");
  base.def(nb::init<>())
      .def_prop_rw("pose", &BaseGroup::pose, &BaseGroup::SetPose,
                   "Pose in the world. Setting it teleports a mocap, free, planar or driven base, "
                   "and leaves behind what the robot holds; a fixed base raises ArgumentError.")
      .def_prop_ro("is_mobile", &BaseGroup::is_mobile,
                   "True for a free, planar or driven base, which moves while the simulation runs.")
      .def_prop_ro("is_driven", &BaseGroup::is_driven,
                   "True if `update` moves the base to `target`, as for a driven base.")
      .def_prop_rw(
          "target", &BaseGroup::target, &BaseGroup::SetTarget,
          "Target pose of a driven base in the world. The base moves there within its largest "
          "speeds and with what the robot holds. Raises ArgumentError for other bases.")
      .def_prop_rw(
          "max_linear_speed", [](const BaseGroup& b) { return b.max_speeds().linear; },
          [](BaseGroup& b, double speed) {
            b.SetMaxSpeeds({.linear = speed, .angular = b.max_speeds().angular});
          },
          "Largest speed of a driven base, m/s.")
      .def_prop_rw(
          "max_angular_speed", [](const BaseGroup& b) { return b.max_speeds().angular; },
          [](BaseGroup& b, double speed) {
            b.SetMaxSpeeds({.linear = b.max_speeds().linear, .angular = speed});
          },
          "Largest angular speed of a driven base, rad/s.");
  for (const nb::handle type : {nb::handle(group), nb::handle(gripper), nb::handle(base)})
    GuardGroup(type);
}

void BindAction(nb::module_& m) {
  nb::class_<GroupCommand>(
      m, "GroupCommand",
      "The command of one group until the next policy tick."
      "\n\nExamples:\n"
      "    >>> command = rc.control.GroupCommand.joints(robot.jnt_pos_msr)\n"
      "    >>> robot.apply({\"arm\": command, \"gripper\": rc.control.GroupCommand.opening(1.0)})\n"
      "    (True, '')")
      .def_static(
          "joints", [](nb::handle q) { return GroupCommand::Joints(ToRow(q, "joints")); }, "q"_a,
          "Commands absolute joint positions, rad or m."
          "\n\nExamples:\n"
          "    >>> command = rc.control.GroupCommand.joints([0, 0.25, 0, 1.65, 0, 1.24, 0])")
      .def_static(
          "relative_joints",
          [](nb::handle dq) { return GroupCommand::RelativeJoints(ToRow(dq, "relative_joints")); },
          "dq"_a, "Commands joint positions relative to the present target.")
      .def_static(
          "leaf_pose", [](const PoseOrFrame& p) { return GroupCommand::LeafPose(p.get()); },
          "leaf_in_robot"_a,
          "Commands a pose of the leaf frame in the robot base frame, through IK."
          "\n\nExamples:\n"
          "    >>> command = rc.control.GroupCommand.leaf_pose(robot.fk_frame())")
      .def_static("base_pose", &GroupCommand::BasePose, "base_in_world"_a,
                  "Commands a pose of a driven base in the world, to which `update` moves it.")
      .def_static("opening", &GroupCommand::Opening, "opening"_a,
                  "Commands the opening of a gripper, 0 closed ... 1 open."
                  "\n\nExamples:\n"
                  "    >>> robot.apply({\"gripper\": rc.control.GroupCommand.opening(1)})\n"
                  "    (True, '')")
      .def_static(
          "velocities",
          [](nb::handle v) { return GroupCommand::Velocities(ToRow(v, "velocities")); }, "v"_a,
          "Commands joint velocities, for a controller that takes them.")
      .def_static(
          "torques", [](nb::handle t) { return GroupCommand::Torques(ToRow(t, "torques")); }, "t"_a,
          "Commands joint torques, for a controller that takes them.")
      .def_prop_ro(
          "values", [](const GroupCommand& c) { return NewArray(c.values); },
          "The numbers of the command (n,), a copy; empty for poses.")
      .def_ro("pose", &GroupCommand::pose, "The pose of the command; the identity for others.");
}

nb::object Values(std::span<const double> values) {
  return NewArray<double>(values, {values.size()});
}

// Returns the most specific class that Python knows; it keeps the robot alive, and itself if it is
// replaced. A group written in Python is its own object, and lives without the robot.
nb::object GroupObject(const Robot& robot, MoveGroup& group) {
  if (const auto* own = dynamic_cast<WrittenInPython*>(&group)) return own->object();
  std::shared_ptr<MoveGroup> shared = robot.shared_group(group.name());
  if (auto gripper = std::dynamic_pointer_cast<GripperGroup>(shared)) return nb::cast(gripper);
  if (auto base = std::dynamic_pointer_cast<BaseGroup>(shared)) return nb::cast(base);
  return nb::cast(shared);
}

void BindRobotClass(nb::module_& m) {
  nb::class_<Robot> robot(
      m, "Robot",
      "A robot of a scene: its move groups, kinematics and controllers.\n\nAll "
      "handles to one robot of one scene share their state, which the scene keeps."
      "\n\nExamples:\n"
      "    >>> robot = rc.Robot.of(scene, \"arm\")\n"
      "    >>> robot.jnt_pos_cmd[0] += 0.3\n"
      "    >>> for _ in range(500):\n"
      "    ...     robot.update()\n"
      "    ...     result = scene.step()\n"
      "    >>> bool(abs(robot.jnt_pos_msr[0] - 0.3) < 0.01)\n"
      "    True",
      nb::type_slots(kHandleSlots<Robot, &VisitRobot>));
  GuardHandle<Robot>(
      robot, [](const Robot& r, SceneClaims& claims) { claims.Add(r.use()); },
      [](const Robot& r) { r.RequireOpen(); }, {.always = {"name", "prefix", "scene"}});
  DefRobotIk(robot);
  robot.def(nb::init<const Robot&>(), "robot"_a, "Makes another handle to the same robot.")
      .def_static("of", &Robot::Of, "scene"_a, "name"_a, Unlocked(),
                  "Returns a configured robot by its name in the scene."
                  "\n\nExamples:\n"
                  "    >>> rc.Robot.of(scene, \"arm\").group_names\n"
                  "    ['arm', 'gripper', 'base']")
      .def_static(
          "from_scene",
          [](const Scene& scene, const std::string& base, const std::string& tip,
             const std::string& prefix, const ToolFrameSpec* tool) {
            return Robot::FromScene(scene, base, tip,
                                    {.prefix = prefix, .tool = tool ? *tool : ToolFrameSpec{}});
          },
          "scene"_a, "base_body"_a, "tip_body"_a, "prefix"_a = "", "tool"_a = nb::none(),
          Unlocked(),
          "Makes a robot without configuration: the chain between two bodies, driven by the "
          "position servos, velocity servos or motors on its joints.\n\nRobots whose arm has the "
          "same joints and actuators, configured or not, share its mode, controller and command "
          "ports; making one does not change these. A robot that has only some of the actuators of "
          "a driven arm, or others too, can only be measured; its ports say which arm has the "
          "actuators."
          "\n\nExamples:\n"
          "    >>> chain_only = rc.Robot.from_scene(scene, \"base_link\", \"link7\")\n"
          "    >>> chain_only.n_joints\n"
          "    7")
      .def_prop_ro("name", &Robot::name, "Name of the robot in its scene.")
      .def_prop_ro("prefix", &Robot::prefix, "Prefix of the robot's names in the model.")
      .def_prop_ro("scene", &Robot::scene,
                   "The scene that the robot is in."
                   "\n\nExamples:\n"
                   "    >>> robot.scene.robots\n"
                   "    [<Robot 'arm'>]")
      .def_prop_ro("group_names", &Robot::group_names, "Names of the move groups.")
      .def(
          "group",
          [](const Robot& r, const std::string& name) { return GroupObject(r, r.group(name)); },
          "name"_a, nb::sig("def group(self, name: str) -> MoveGroup"),
          "Returns a group by name: a GripperGroup, a BaseGroup or a plain MoveGroup."
          "\n\nExamples:\n"
          "    >>> robot.group(\"gripper\").nu\n"
          "    1")
      .def_prop_ro(
          "groups",
          [](const Robot& r) {
            nb::dict groups;
            for (const std::string& name : r.group_names()) {
              groups[nb::str(name.c_str())] = GroupObject(r, r.group(name));
            }
            return groups;
          },
          nb::sig("def groups(self, /) -> dict[str, MoveGroup]"), "The move groups by name.")
      .def_prop_ro(
          "arm", [](const Robot& r) { return GroupObject(r, r.arm()); },
          nb::sig("def arm(self, /) -> MoveGroup"),
          "The first arm. Raises NotFoundError for a robot without one."
          "\n\nExamples:\n"
          "    >>> robot.arm.joint_pos.shape\n"
          "    (7,)")
      .def_prop_ro(
          "gripper", [](const Robot& r) { return GroupObject(r, r.gripper()); },
          nb::sig("def gripper(self, /) -> GripperGroup"),
          "The first arm's gripper. Raises NotFoundError for a robot without one."
          "\n\nExamples:\n"
          "    >>> robot.gripper.opening = 1")
      .def_prop_ro("has_gripper", &Robot::has_gripper, "True if the robot has a gripper.")
      .def(
          "gripper_of",
          [](const Robot& r, const std::string& arm) -> std::optional<std::string> {
            const std::string gripper = r.gripper_of(arm);
            return gripper.empty() ? std::nullopt : std::optional(gripper);
          },
          "arm"_a,
          "Returns the name of an arm's gripper: the first in the file that is attached to the "
          "arm's last link, else the first that no other arm carries; None without one. `gripper` "
          "is that of the first arm. Raises ArgumentError for a group that is not an arm.")
      .def_prop_ro(
          "base", [](const Robot& r) { return GroupObject(r, r.base()); },
          nb::sig("def base(self, /) -> BaseGroup"),
          "The group of the base. Raises NotFoundError for a robot without one.")
      .def(
          "set_group",
          [](Robot& r, nb::handle_t<MoveGroup> group) {
            TrackScene(r.scene());
            r.SetGroup(KeepGroup(nb::borrow(group)));
          },
          "group"_a,
          "Adds a group written in Python, or replaces one by it. The robot keeps the object.")
      .def(
          "apply",
          [](Robot& r, const RobotAction& action) {
            const Robot::ApplyResult result = r.Apply(action);
            return std::pair(result.ok, result.failed_group);
          },
          "action"_a, Unlocked(),
          "Sets the targets of the groups named: {group: GroupCommand}. Returns (ok, failed "
          "group)."
          "\n\nExamples:\n"
          "    >>> robot.apply({\"arm\": rc.control.GroupCommand.relative_joints([0.1, 0, 0, 0, 0, "
          "0, 0])})\n"
          "    (True, '')")
      .def("update", &Robot::Update, Unlocked(),
           "Reads the state into the ports and runs every group's controller once."
           "\n\nExamples:\n"
           "    >>> robot.update()")
      .def(
          "step", [](Robot& r) { return r.Step(); }, nb::call_guard<nb::gil_scoped_release>(),
          "Makes one step of the whole scene.")
      .def(
          "step_n", [](Robot& r, int n) { return r.StepN(n); }, "n"_a, Unlocked(),
          "Makes n steps of the whole scene, without update() in between.")
      .def_prop_rw(
          "paused", &Robot::paused, &Robot::set_paused,
          "While True, step() and step_n() of this robot do nothing; those of the scene and of "
          "other robots work, and so does update(). The value survives resets and rebuilds.")
      .def_prop_ro("n_joints", &Robot::n_joints, "Number of joints of the arm, n.")
      .def_prop_ro("joint_names", &Robot::joint_names,
                   "Names of the arm's joints in the model, in chain order.")
      .def_prop_ro(
          "joint_limits", [](const Robot& r) { return IntervalArray(r.joint_limits()); },
          "Joint limits (n, 2), rad or m; infinite for joints without limits."
          "\n\nExamples:\n"
          "    >>> robot.joint_limits.shape\n"
          "    (7, 2)")
      .def_prop_ro(
          "jnt_pos_msr", [](const Robot& r) { return Values(r.jnt_pos_msr()); },
          "Joint positions (n,) at the last update(), rad or m; a copy."
          "\n\nExamples:\n"
          "    >>> robot.update()\n"
          "    >>> robot.jnt_pos_msr.shape\n"
          "    (7,)")
      .def_prop_ro(
          "jnt_vel_msr", [](const Robot& r) { return Values(r.jnt_vel_msr()); },
          "Joint velocities (n,) at the last update(), rad/s or m/s; a copy.")
      .def_prop_ro(
          "jnt_trq_msr", [](const Robot& r) { return Values(r.jnt_trq_msr()); },
          "Torques of the actuators (n,) at the last update(), Nm or N; a copy.")
      .def(
          "set_joint_pos",
          [](Robot& r, nb::handle q, bool call_forward) {
            r.SetJointPos(ToRow(q, "q"), call_forward);
          },
          "q"_a, "call_forward"_a = true,
          "Teleports the arm, resets its port and lets its actuators hold it there; velocities "
          "stay. Positions beyond the limits are accepted, and the limits push back, which is "
          "logged once. Without `call_forward` poses are updated on demand, and everything else by "
          "the next step."
          "\n\nExamples:\n"
          "    >>> robot.set_joint_pos([0, 0.25, 0, 1.65, 0, 1.24, 0])")
      .def(
          "fk_frame",
          [](const Robot& r, nb::handle q) {
            return q.is_none() ? r.FkFrame() : r.FkFrame(ToRow(q, "q"));
          },
          "q"_a = nb::none(),
          "Returns the pose of the TCP in the robot base frame."
          "\n\nExamples:\n"
          "    >>> robot.fk_frame().is_close(robot.base_in_world.inverse() * robot.tcp_in_world)\n"
          "    True")
      .def(
          "copy_config", [](const Robot& r) { return RobotConfig(r.config()); },
          "Returns a copy of the robot's configuration: that of its file or spec, or an empty one "
          "(name and model at most). Changing the copy changes no robot; build a scene with it.")
      .def_prop_ro(
          "kinematics", [](const Robot& r) { return Kinematics{r}; },
          "Kinematics of the arm, single and in batches."
          "\n\nExamples:\n"
          "    >>> poses = robot.kinematics.fk(np.zeros((100, 7)))\n"
          "    >>> poses.shape\n"
          "    (100, 4, 4)")
      .def_prop_ro("base_in_world", &Robot::base_in_world,
                   "Pose of the robot base frame in the world."
                   "\n\nExamples:\n"
                   "    >>> robot.base_in_world.translation.shape\n"
                   "    (3,)")
      .def_prop_ro("tcp_in_world", &Robot::tcp_in_world,
                   "Pose of the TCP in the world."
                   "\n\nExamples:\n"
                   "    >>> robot.tcp_in_world.translation.shape\n"
                   "    (3,)")
      .def_prop_ro("reach", &Robot::reach, Unlocked(),
                   "Farthest distance of the TCP from the root body, metres.")
      .def_prop_ro("ft_sensor_names", &Robot::ft_sensor_names, "Names of the force-torque sensors.")
      .def(
          "ft_sensor",
          [](const Robot& r, const std::string& name) { return ToPyKdl(r.ft_sensor(name)); },
          "name"_a, nb::sig("def ft_sensor(self, name: str) -> typing.Any"),
          "Returns the reading of a force-torque sensor at the last update(), as a PyKDL.Wrench: "
          "the load on the sensor (a mass that hangs from it reads its weight, along gravity), N "
          "and Nm, in the axes and about the origin of its `frame_site`.\n\nNotFoundError lists "
          "the sensors, ImportError with the install command if PyKDL is missing.")
      .def(
          "ft_sensor_wrench",
          [](const Robot& r, const std::string& name) {
            const Eigen::Matrix<double, 6, 1> six = r.ft_sensor(name).vector();
            return Values({six.data(), 6});
          },
          "name"_a,
          nb::sig("def ft_sensor_wrench(self, name: str) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the reading as numbers (6,): force, then torque.")
      .def("ft_sensor_frame", &Robot::ft_sensor_frame, "name"_a,
           "Returns the pose in the world of the site whose axes the reading has.")
      .def("tare_ft_sensor", &Robot::TareFtSensor, "name"_a,
           "Subtracts the present reading, of the last step or forward(), from later readings "
           "until the next reset.")
      .def(
          "kdl_chain", [](const Robot& r) { return ToPyKdl(r.chain()); },
          nb::sig("def kdl_chain(self) -> typing.Any"),
          "Returns the arm as a PyKDL.Chain from the robot base frame to the TCP, with its masses; "
          "joint values are the model's.\n\nPyKDL's solvers do not keep their chain. The robot "
          "keeps it as long as it lives, so that `PyKDL.ChainDynParam(robot.kdl_chain(), gravity)` "
          "is safe. It is the same object each time, until masses or lengths of the arm change (an "
          "object on it, refresh_tool_inertia) or you added segments to it.\n\nRaises ImportError "
          "with the install command if PyKDL is missing."
          "\n\nExamples:\n"
          "    >>> robot.kdl_chain().getNrOfJoints()\n"
          "    7")
      .def_prop_ro(
          "chain", [](const Robot& r) { return Chain(r.chain()); },
          "A copy of the arm's present kinematics and dynamics, from the robot base frame to the "
          "TCP."
          "\n\nExamples:\n"
          "    >>> robot.chain.jacobian(robot.jnt_pos_msr).shape\n"
          "    (6, 7)")
      .def(
          "gravity_torques",
          [](const Robot& r, std::optional<double> gravity_z) {
            std::vector<double> torques(static_cast<size_t>(r.n_joints()));
            r.GravityTorques(torques, gravity_z);
            for (double& torque : torques) torque += 0.0;  // not -0
            return NewArray(torques);
          },
          "gravity_z"_a = nb::none(),
          "Returns the torques (n,) that hold the arm where it is against the scene's gravity, or "
          "against `gravity_z` along the world's z axis, m/s^2. Bodies with gravcomp count less. "
          "The scene's gravity is zero if its options disable it."
          "\n\nExamples:\n"
          "    >>> robot.gravity_torques().shape\n"
          "    (7,)")
      .def(
          "gravity_in_base",
          [](const Robot& r, std::optional<double> gravity_z) {
            const Eigen::Vector3d gravity = r.gravity_in_base(gravity_z);
            return Values({gravity.data(), 3});
          },
          "gravity_z"_a = nb::none(),
          "Returns the scene's gravity (3,) in the axes of the robot base frame, for the dynamics "
          "of `chain`.")
      .def("refresh_tool_inertia", &Robot::RefreshToolInertia,
           "Recomputes the inertia of attached bodies (gripper, tool) at their present pose "
           "instead of the model's reference, until the next reset.")
      .def_prop_ro("has_tcp_frame", &Robot::has_tcp_frame,
                   "True if the arm ends in a site instead of a body's frame.")
      .def_prop_ro("tcp_site", &Robot::tcp_site,
                   "Full name of the TCP's site; '' if the arm ends in a body.")
      .def_prop_ro("tip_to_tcp", &Robot::tip_to_tcp,
                   "Pose of the TCP in the tip body: the last body that the arm moves, or the one "
                   "given to from_scene.")
      .def("is_driven", &Robot::is_driven, "group"_a,
           "Returns True if the group has a controller, which `update` runs.")
      .def("__repr__", [](const Robot& r) { return "<Robot '" + r.name() + "'>"; });
  DefControl(robot);
  m.def("robots_of", &RobotsOf, "scene"_a, Unlocked(),
        "Returns all configured robots of a scene."
        "\n\nExamples:\n"
        "    >>> [robot.name for robot in rc.robots.robots_of(scene)]\n"
        "    ['arm']");
}

void BindStepper(nb::module_& m) {
  nb::class_<StepOutcome>(m, "StepOutcome", "Result of a policy tick.")
      .def_ro("step", &StepOutcome::step, "StepResult of the whole policy tick.")
      .def_ro("failed_robot", &StepOutcome::failed_robot,
              "First robot whose pose command had no IK solution; \"\" without one. It keeps its "
              "target.")
      .def_ro("failed_group", &StepOutcome::failed_group, "The group of that robot.")
      .def_prop_ro("ok", &StepOutcome::ok, "True if the simulation did not diverge.");
  nb::class_<Stepper> stepper(m, "Stepper",
                              "Drives robots and engine: in each control tick every robot's "
                              "update, then the engine's steps.",
                              nb::type_slots(kHandleSlots<Stepper, &VisitStepper>));
  GuardHandle<Stepper>(
      stepper, [](const Stepper& s, SceneClaims& claims) { claims.Add(s.scene()); },
      [](const Stepper& s) { RequireOpen(s.scene(), "stepper"); });
  stepper
      .def(
          "__init__",
          [](Stepper* self, const Scene& scene, const std::vector<Robot>& robots, int ticks,
             int steps) {
            new (self) Stepper(scene, robots, {ticks, steps});
            self->set_on_control_tick(
                [poll = SignalPoll()](const mjModel*, const mjData*) mutable { poll(); });
          },
          "scene"_a, "robots"_a, "control_ticks"_a = 33, "sim_steps"_a = 1)
      .def("advance", &Stepper::Advance, "action"_a, nb::call_guard<nb::gil_scoped_release>(),
           "Applies {robot: {group: GroupCommand}} and advances by one policy tick.")
      .def_prop_ro("policy_ticks", &Stepper::policy_ticks, "Number of policy ticks so far.");
}

}  // namespace

void BindRobot(nb::module_& m) {
  BindGroups(m);
  BindAction(m);
  BindControllers(m);
  BindRobotClass(m);
  BindStepper(m);
}

}  // namespace robocell::python
