#include "control.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>

#include "arrays.h"
#include "handles.h"
#include "kinematics.h"
#include "number_like.h"
#include "scene_cycles.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/control/cartesian_impedance_controller.h"
#include "robocell/control/cartesian_pose_controller.h"
#include "robocell/control/differential_ik_controller.h"
#include "robocell/control/joint_impedance_controller.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

// Robot::shared_controller gives it a handle to its robot.
int VisitController(const Controller& controller, visitproc visit, void* arg) {
  return controller.scene() ? VisitScene(*controller.scene(), visit, arg) : 0;
}

nb::object Copy(std::span<const double> values) { return NumberCopy(values); }

CtrlMode ToCtrlMode(nb::handle value) {
  if (CtrlMode mode{}; nb::try_cast(value, mode, /*convert=*/false)) return mode;
  const FieldPath path("ctrl_mode");
  const std::vector<std::string> names = ValueNames<CtrlMode>();
  if (!IsText(value)) ThrowType(path, "a CtrlMode or one of " + ListNames(names), value);
  const std::string text = ToText(value, path);
  for (const auto& [mode, name] : EnumNames<CtrlMode>::kNames) {
    if (text == name) return mode;
  }
  ThrowValue(path, "must be one of " + ListNames(names) + ", got '" + text + "'." +
                       DidYouMean(text, names));
}

// Returns the most specific class that Python knows. The object keeps the robot alive, and itself
// if it is replaced.
nb::object ControllerObject(const Robot& robot, const std::string& group) {
  const std::shared_ptr<Controller> shared = robot.shared_controller(group);
  if (auto c = std::dynamic_pointer_cast<JointImpedanceController>(shared)) return nb::cast(c);
  if (auto c = std::dynamic_pointer_cast<CartesianPoseController>(shared)) return nb::cast(c);
  if (auto c = std::dynamic_pointer_cast<CartesianImpedanceController>(shared)) return nb::cast(c);
  if (auto c = std::dynamic_pointer_cast<DifferentialIkController>(shared)) return nb::cast(c);
  return nb::cast(shared);
}

using View = nb::ndarray<nb::numpy, double, nb::ndim<1>>;

// A writable view of a command port; it keeps the robot alive, and the port if its controller is
// replaced.
View PortView(const Robot& robot, std::span<double> port) {
  using Keeper = std::shared_ptr<Controller>;
  const nb::capsule owner(new Keeper(robot.shared_controller(robot.arm().name())),
                          [](void* keeper) noexcept { delete static_cast<Keeper*>(keeper); });
  return {port.data(), {port.size()}, owner};
}

CartesianImpedanceController::Gains ToSix(nb::handle values, const char* name) {
  const FieldPath path(name);
  const Numbers six(values, path, 6);
  CartesianImpedanceController::Gains gains;
  std::copy(six.span().begin(), six.span().end(), gains.begin());
  return gains;
}

// Properties of controllers whose target is a pose.
template <class C>
void DefPose(nb::class_<C, Controller>& c) {
  c.def_prop_rw(
       "pose", [](const C& self) { return self.pose(); },
       [](C& self, const PoseOrFrame& pose) { self.SetPose(pose.get()); },
       "Target pose of the leaf frame in the robot base frame. A PyKDL.Frame is also accepted.")
      .def_prop_rw(
          "posture", [](const C& self) { return Copy(self.posture()); },
          [](C& self, nb::handle q) { self.SetPosture(ToRow(q, "posture")); },
          nb::for_getter(nb::sig("def posture(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def posture(self, value: object, /) -> None")),
          "Joint positions (n,) that redundant joints move to. Default: the arm's positions when "
          "the controller was installed.");
}

void BindJointImpedance(nb::module_& m) {
  using C = JointImpedanceController;
  nb::class_<C, Controller>(
      m, "JointImpedanceController",
      "Each joint is a spring and a damper towards its target; the weight of the arm is "
      "compensated.\n\ntorque = stiffness * (target - q) - damping * qd + gravity + Coriolis. "
      "Targets are joint positions, also robot.jnt_pos_cmd.")
      .def_prop_rw(
          "stiffness", [](const C& c) { return Copy(c.stiffness()); },
          [](C& c, nb::handle value) {
            const FieldPath path("stiffness");
            if (IsNumber(value)) {
              const double one = ToDouble(value, path);
              return c.SetStiffness({&one, 1});
            }
            c.SetStiffness(ToRow(value, "stiffness"));
          },
          nb::for_getter(nb::sig("def stiffness(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def stiffness(self, value: object, /) -> None")),
          "Stiffness (n,), Nm/rad or N/m; one number applies to all joints. By default joints "
          "swing with 3 Hz, light ones faster.")
      .def_prop_rw("damping_ratio", &C::damping_ratio, &C::SetDampingRatio,
                   "Damping ratio; 1 is critical damping.");
}

void BindCartesianPose(nb::module_& m) {
  using C = CartesianPoseController;
  nb::class_<C, Controller> c(m, "CartesianPoseController",
                              "Moves the leaf frame to its target on a straight line, through "
                              "position servos, within max_linear_speed and max_angular_speed.");
  DefPose(c);
  c.def_prop_rw(
       "max_linear_speed", &C::max_linear_speed,
       [](C& self, double v) { self.SetMaxSpeeds(v, self.max_angular_speed()); },
       "Largest speed of the leaf frame, m/s.")
      .def_prop_rw(
          "max_angular_speed", &C::max_angular_speed,
          [](C& self, double v) { self.SetMaxSpeeds(self.max_linear_speed(), v); },
          "Largest angular speed of the leaf frame, rad/s.");
}

void BindCartesianImpedance(nb::module_& m) {
  using C = CartesianImpedanceController;
  nb::class_<C, Controller> c(
      m, "CartesianImpedanceController",
      "Springs and dampers along and about the axes of the robot base frame hold the TCP at its "
      "target; a null-space task pulls redundant joints towards a posture without moving the TCP.");
  DefPose(c);
  c.def_prop_rw(
       "stiffness", [](const C& self) { return Copy(self.stiffness()); },
       [](C& self, nb::handle k) { self.SetStiffness(ToSix(k, "stiffness")); },
       nb::for_getter(nb::sig("def stiffness(self, /) -> numpy.typing.NDArray[numpy.float64]")),
       nb::for_setter(nb::sig("def stiffness(self, value: numpy.typing.ArrayLike, /) -> None")),
       "Stiffness (6,): N/m along x y z, then Nm/rad about them.")
      .def_prop_rw("damping_ratio", &C::damping_ratio, &C::SetDampingRatio,
                   "Damping ratio; 1 is critical damping.")
      .def_prop_rw("posture_frequency", &C::posture_frequency, &C::SetPostureFrequency,
                   "Frequency at which redundant joints would swing around the posture, rad/s; 0 "
                   "leaves them free.")
      .def_prop_rw(
          "feedforward", [](const C& self) { return Copy(self.feedforward()); },
          [](C& self, nb::handle wrench) {
            if (const auto kdl = FromPyKdlWrench(wrench)) {
              const auto six = kdl->vector();
              return self.SetFeedforward({six[0], six[1], six[2], six[3], six[4], six[5]});
            }
            self.SetFeedforward(ToSix(wrench, "feedforward"));
          },
          nb::for_getter(
              nb::sig("def feedforward(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def feedforward(self, value: object, /) -> None")),
          "Wrench (6,) that the arm adds on what it touches: N, then Nm, in the axes of the robot "
          "base frame. A PyKDL.Wrench is also accepted.");
}

void BindDifferentialIk(nb::module_& m) {
  using C = DifferentialIkController;
  nb::class_<C, Controller>(
      m, "DifferentialIkController",
      "Moves the leaf frame with a twist, through position servos, until the next target. Joints "
      "stay within their limits and speeds, and slow down near singularities.")
      .def_prop_rw(
          "twist", [](const C& self) { return Copy(self.target()); },
          [](C& self, nb::handle twist) {
            const FieldPath path("twist");
            self.SetTarget(Numbers(twist, path, 6));
          },
          nb::for_getter(nb::sig("def twist(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def twist(self, value: numpy.typing.ArrayLike, /) -> None")),
          "Target twist (6,): linear, then angular velocity of the leaf frame, m/s and rad/s, in "
          "the axes of `frame`.")
      .def_prop_rw(
          "frame", [](const C& self) { return TwistFrameName(self.frame()); },
          [](C& self, nb::handle frame) { self.SetFrame(ToTwistFrame(frame)); },
          nb::for_getter(nb::sig("def frame(self, /) -> str")),
          nb::for_setter(nb::sig("def frame(self, value: str, /) -> None")),
          "Frame whose axes the twist has: 'base' (the robot base frame), 'tip' or 'world'.")
      .def_prop_rw(
          "max_speed", [](const C& self) { return Copy(self.max_speed()); },
          [](C& self, nb::handle speed) { self.SetMaxSpeed(ToRow(speed, "max_speed")); },
          nb::for_getter(nb::sig("def max_speed(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def max_speed(self, value: object, /) -> None")),
          "Largest speed (n,) of each joint, rad/s or m/s. Default: pi.")
      .def_prop_rw(
          "posture", [](const C& self) { return Copy(self.posture()); },
          [](C& self, nb::handle q) { self.SetPosture(ToRow(q, "posture")); },
          nb::for_getter(nb::sig("def posture(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def posture(self, value: object, /) -> None")),
          "Joint positions (n,) that redundant joints move to. Default: the arm's positions when "
          "the controller was installed.")
      .def_prop_rw("posture_rate", &C::posture_rate, &C::SetPostureRate,
                   "Rate at which redundant joints approach the posture, as a share of the "
                   "distance per second; 0 leaves them at rest.")
      .def_prop_ro("slower", &C::slower,
                   "True if the TCP moves slower than its last target twist.");
}

}  // namespace

void BindControllers(nb::module_& m) {
  nb::class_<Controller> controller(
      m, "Controller",
      "Turns the state and a target into the controls of one move group. robot.update() runs the "
      "controller.",
      nb::type_slots(kHandleSlots<Controller, &VisitController, HandleIs::kShared>));
  controller
      .def_prop_ro(
          "kind", [](const Controller& c) { return std::string(c.kind()); },
          "Kind of the controller, as in ControlKind: \"joint_position\", \"joint_torque\", ...")
      .def_prop_ro("mode", &Controller::mode, "The CtrlMode that the controller drives.")
      .def_prop_rw(
          "target", [](const Controller& c) { return Copy(c.target()); },
          [](Controller& c, nb::handle target) { c.SetTarget(ToRow(target, "target")); },
          nb::for_getter(nb::sig("def target(self, /) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def target(self, value: object, /) -> None")),
          "A copy of the target (n,); its meaning depends on the kind.")
      .def("reset", &Controller::Reset, "Drops the target and holds the present position.");
  BindJointImpedance(m);
  BindCartesianPose(m);
  BindCartesianImpedance(m);
  BindDifferentialIk(m);
  for (const nb::handle type :
       {nb::handle(controller), nb::type<JointImpedanceController>(),
        nb::type<CartesianPoseController>(), nb::type<CartesianImpedanceController>(),
        nb::type<DifferentialIkController>()})
    GuardHandle<Controller>(
        type, [](const Controller& c, SceneClaims& claims) { claims.Add(c.scene()); },
        [](const Controller& c) { c.RequireOpen(); }, {.always = {"kind"}});
}

void DefControl(nb::class_<Robot>& robot) {
  robot
      .def_prop_rw(
          "jnt_pos_cmd", [](const Robot& r) { return PortView(r, r.jnt_pos_cmd()); },
          [](Robot& r, nb::handle q) { r.SetJntPosCmd(ToRow(q, "jnt_pos_cmd")); },
          nb::rv_policy::automatic, nb::for_setter(nb::arg("q").none()),
          nb::for_setter(nb::sig("def jnt_pos_cmd(self, q: object, /) -> None")),
          "Joint position targets (n,) of the arm, rad or m: a view that you can write in place, "
          "and "
          "that stays valid when the mode changes. It drives the arm in position mode; values "
          "written in another mode count after the switch. Values beyond a joint's limits drive it "
          "to the limit, and the log reports this once."
          "\n\nExamples:\n"
          "    >>> robot.jnt_pos_cmd[0] += 0.3")
      .def_prop_rw(
          "jnt_vel_cmd", [](const Robot& r) { return PortView(r, r.jnt_vel_cmd()); },
          [](Robot& r, nb::handle v) { r.SetJntVelCmd(ToRow(v, "jnt_vel_cmd")); },
          nb::rv_policy::automatic, nb::for_setter(nb::arg("v").none()),
          nb::for_setter(nb::sig("def jnt_vel_cmd(self, v: object, /) -> None")),
          "Joint velocity commands (n,) of the arm, rad/s or m/s: a view like jnt_pos_cmd. It "
          "drives "
          "the arm in velocity mode.")
      .def_prop_rw(
          "jnt_trq_cmd", [](const Robot& r) { return PortView(r, r.jnt_trq_cmd()); },
          [](Robot& r, nb::handle t) { r.SetJntTrqCmd(ToRow(t, "jnt_trq_cmd")); },
          nb::rv_policy::automatic, nb::for_setter(nb::arg("t").none()),
          nb::for_setter(nb::sig("def jnt_trq_cmd(self, t: object, /) -> None")),
          "Joint torque commands (n,) of the arm, Nm or N: a view like jnt_pos_cmd. It drives the "
          "arm "
          "in torque mode."
          "\n\nExamples:\n"
          "    >>> robot.ctrl_mode = rc.control.CtrlMode.TORQUE\n"
          "    >>> robot.jnt_trq_cmd[:] = robot.gravity_torques()\n"
          "    >>> robot.update()")
      .def_prop_rw(
          "ctrl_mode", &Robot::ctrl_mode,
          [](Robot& r, nb::handle mode) { r.set_ctrl_mode(ToCtrlMode(mode)); },
          nb::for_setter(nb::arg("mode").none()),
          nb::for_setter(nb::sig("def ctrl_mode(self, mode: CtrlMode | str, /) -> None")),
          "The mode that drives the arm in the scene, the same for all robots made of this arm. "
          "Setting it switches at once, and installs the controller of that port: joint_position, "
          "joint_velocity or joint_torque. For an arm at rest without a load, forces do not jump."
          "\n\nExamples:\n"
          "    >>> robot.ctrl_mode = rc.control.CtrlMode.TORQUE\n"
          "    >>> robot.ctrl_mode\n"
          "    CtrlMode.TORQUE")
      .def("controller", &ControllerObject, "group"_a = "arm",
           nb::sig("def controller(self, group: str = 'arm') -> Controller"),
           "Returns a group's controller. For a group without one it raises NotFoundError with the "
           "reason.")
      .def(
          "set_controller",
          [](Robot& r, const std::string& group, const std::string& kind) {
            r.SetController(group, kind);
            return ControllerObject(r, group);
          },
          "group"_a, "kind"_a,
          nb::sig("def set_controller(self, group: str, kind: str) -> Controller"),
          "Installs a controller, switches the group to the mode that it drives, and returns it."
          "\n\nExamples:\n"
          "    >>> controller = robot.set_controller(\"arm\", \"joint_impedance\")\n"
          "    >>> controller.target.shape\n"
          "    (7,)");
}

}  // namespace robocell::python
