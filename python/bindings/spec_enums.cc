// The specs' enums, with a docstring for each value.
#include "spec_enums.h"

#include <array>
#include <cctype>

#include "bindings.h"
#include "spec_class.h"
#include "spec_parts.h"

namespace robocell::python {

std::string UpperCase(std::string_view name) {
  std::string out(name);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

std::string CamelCase(std::string_view name) {
  std::string out;
  bool start = true;
  for (const char c : name) {
    if (c != '_') out += start ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    start = c == '_';
  }
  return out;
}

namespace {

// `meanings`: the docstring of each value, in the order of EnumNames.
template <HasEnumNames E>
void BindEnum(nb::module_& m, const char* doc,
              const std::array<const char*, EnumNames<E>::kNames.size()>& meanings,
              std::string (*style)(std::string_view) = UpperCase) {
  nb::enum_<E> e(m, kEnumName<E>, doc);
  for (size_t i = 0; i < meanings.size(); ++i) {
    const auto& [value, name] = EnumNames<E>::kNames[i];
    e.value(KeepText(style(name)), value, meanings[i]);
  }
}

void BindElementEnums(nb::module_& m) {
  BindEnum<AttachKind>(
      m,
      "Kinds of attachment targets."
      "\n\nExamples:\n"
      "    >>> rc.robots.AttachTarget(rc.robots.AttachKind.Site, \"pinch_site\")\n"
      "    AttachTarget(AttachKind.Site, 'pinch_site')",
      {"The world frame.", "The rig's root frame, `root_frame_to_world`.",
       "The rig's shared base frame.", "A body, by its full name.", "A site, by its full name.",
       "A frame, by its full name.", "The root body of the robot of that name.",
       "The attachment site of the robot of that name."},
      CamelCase);
  BindEnum<ElementKind>(
      m, "Kinds of elements of a model.",
      {"A body.", "A site.", "A geom.", "A joint.", "A camera.", "An actuator.", "A sensor.",
       "A light.", "A tendon.", "An equality constraint.", "A keyframe."});
  BindEnum<Shape>(
      m, "Shapes of primitive objects.",
      {"A box; its size is three half sizes, m.", "A sphere; its size is the radius, 0, 0, m.",
       "A cylinder; its size is the radius, half the height, 0, m."});
  BindEnum<Condim>(m, "Kinds of friction at contacts; the values are MuJoCo's condim.",
                   {"Sliding friction.", "Sliding and torsional friction.",
                    "Sliding, torsional and rolling friction."});
}

void BindEngineEnums(nb::module_& m) {
  BindEnum<Integrator>(m, "MuJoCo's integrators.",
                       {"Semi-implicit Euler.", "Runge-Kutta of fourth order.",
                        "Implicit in velocity, with Coriolis terms.",
                        "Implicit in velocity, without Coriolis terms."});
  BindEnum<FrictionCone>(
      m, "Shapes of friction cones.",
      {"A pyramid, an approximation of the cone.", "The elliptic cone of Coulomb friction."});
  BindEnum<Solver>(m, "MuJoCo's constraint solvers.",
                   {"Projected Gauss-Seidel.", "Conjugate gradients.", "Newton's method."});
  BindEnum<JacobianKind>(
      m, "Storage and factorisation of the constraint Jacobian.",
      {"Dense.", "Sparse.", "Sparse from 60 degrees of freedom on, else dense."});
}

void BindRobotEnums(nb::module_& m) {
  BindEnum<BaseKind>(m, "Kinds of robot bases.",
                     {"Fixed to its parent.", "A mocap body, which can be placed anywhere.",
                      "A free body with six degrees of freedom.", "Joints for x, y and yaw.",
                      "A base that moves to a target and carries grasped objects."});
  BindEnum<MoveGroupKind>(
      m, "Kinds of move groups.",
      {"Joints in a chain, with kinematics and a TCP.", "Fingers, commanded by an opening.",
       "The robot's base.", "Other joints, commanded by position."});
  BindEnum<TaskSpaceKind>(m, "Parts of a commanded pose that count for an arm.",
                          {"Position and rotation.", "The position, with any rotation.",
                           "The position, and the direction of one axis of the TCP."});
  BindEnum<ControlKind>(
      m, "Default controllers of move groups.",
      {"Joint positions; of a gripper its opening.", "Joint positions added to the present target.",
       "Joint velocities.", "Joint torques.", "Joint positions; each joint is a spring and damper.",
       "A TCP pose, followed by inverse kinematics.", "A TCP pose, held by springs and dampers."});
  BindEnum<CtrlMode>(m,
                     "Kinds of actuators that drive an arm's joints."
                     "\n\nExamples:\n"
                     "    >>> robot.ctrl_mode\n"
                     "    CtrlMode.POSITION",
                     {"Position servos.", "Velocity servos.", "Motors."});
}

void BindRunEnums(nb::module_& m) {
  BindEnum<Keep>(
      m, "Kinds of rollouts that a run stores as episodes.",
      {"Successful rollouts only.", "The first rollout of each episode, whatever its result.",
       "Every rollout; failures are labelled."});
  BindEnum<RenderWhen>(m, "Rollouts whose images are drawn.",
                       {"Every rollout, beside its physics.",
                        "Only rollouts that are kept, after they have ended."});
  BindEnum<ControlMode>(
      m,
      "Meaning of an environment's actions."
      "\n\nExamples:\n"
      "    >>> cell = rc.EnvConfig.load(rc.models.cell_file(\"rc7\"))\n"
      "    >>> cell.control_mode = rc.envs.ControlMode.CARTESIAN_TQUAT",
      {"Joint positions, rad or m.", "TCP: x y z, m, and roll pitch yaw, rad (extrinsic xyz).",
       "TCP: x y z, m, and quaternion xyzw."});
  BindEnum<RelativeTo>(
      m, "Reference of an environment's actions.",
      {"The robot's last target.", "The pose at the reset, or at set_origin_to_current.",
       "Nothing: actions are absolute."});
  BindEnum<OnCollision>(m, "Effect of a collision on an environment's step.",
                        {"The step continues.", "The step ends.",
                         "The step is simulated ahead; an action that leads to a collision is not "
                         "executed."});
  BindEnum<Relation>(
      m, "Relations between the places of two objects.",
      {"One lies on the other.", "One lies in a hollow of the other.",
       "One lies beside the other, on the same support, at most the gap (default 0.1 m) away."});
  BindEnum<RandomizeEvery>(m, "How often values are drawn.",
                           {"For each episode.", "Once for each scene."});
}

}  // namespace

void BindEnums(nb::module_& m) {
  BindElementEnums(m);
  BindEngineEnums(m);
  BindRobotEnums(m);
  BindRunEnums(m);
}

}  // namespace robocell::python
