#include "robocell/scene/actuator_kind.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/control_modes.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

// The parameters of an actuator that determine its force.
struct DriveLaw {
  int gain_type, bias_type, dynamics, inputs;
  double gain;
  const double* bias;
  bool moves;  // has a gear
};

// Frames and ball joints can be turned about any of their axes, all other joints have one axis.
bool HasGear(const double* gears, bool several_axes) {
  return std::any_of(gears, gears + (several_axes ? 6 : 1), [](double g) { return g != 0; });
}

bool HasGear(const mjsActuator* a) {
  bool several_axes = a->trntype == mjTRN_SITE;
  if (IsOnJoint(a->trntype)) {
    mjsElement* joint =
        FindSpecElement(mjs_getSpec(a->element), mjOBJ_JOINT, mjs_getString(a->target));
    const int type = joint ? mjs_asJoint(joint)->type : mjJNT_HINGE;
    several_axes = type == mjJNT_BALL || type == mjJNT_FREE;
  }
  return HasGear(a->gear, several_axes);
}

bool HasGear(const mjModel* m, int a) {
  if (*Gears(m, a) != 0) return true;  // about the first axis, which all have
  const int target = m->actuator_trnid[2 * a];
  const int type = ActsOnJoint(m, a) ? m->jnt_type[target] : mjJNT_HINGE;
  return HasGear(Gears(m, a),
                 m->actuator_trntype[a] == mjTRN_SITE || type == mjJNT_BALL || type == mjJNT_FREE);
}

DriveLaw LawOf(const mjsActuator* a) {
  return {a->gaintype, a->biastype, a->dyntype, 1, a->gainprm[0], a->biasprm, HasGear(a)};
}

DriveLaw LawOf(const mjModel* m, int a) {
  return {m->actuator_gaintype[a],
          m->actuator_biastype[a],
          m->actuator_dyntype[a],
          m->actuator_ctrlnum[a],
          m->actuator_gainprm[mjNGAIN * a],
          m->actuator_biasprm + mjNBIAS * a,
          HasGear(m, a)};
}

std::optional<CtrlMode> KindOfForce(const DriveLaw& law) {
  if (!law.moves || law.gain_type != mjGAIN_FIXED || law.gain == 0 || law.inputs != 1)
    return std::nullopt;
  if (law.bias_type == mjBIAS_NONE) return CtrlMode::kTorque;
  if (law.bias_type != mjBIAS_AFFINE) return std::nullopt;
  if (law.bias[1] < 0) return CtrlMode::kPosition;
  const bool of_velocity = law.bias[0] == 0 && law.bias[1] == 0 && law.bias[2] == -law.gain;
  return of_velocity && law.gain > 0 ? std::optional(CtrlMode::kVelocity) : std::nullopt;
}

std::optional<CtrlMode> KindOf(const DriveLaw& law) {
  const std::optional<CtrlMode> kind = KindOfForce(law);
  const bool filtered = law.dynamics == mjDYN_FILTER || law.dynamics == mjDYN_FILTEREXACT;
  const bool may = law.dynamics == mjDYN_NONE || (filtered && kind == CtrlMode::kPosition);
  return may ? kind : std::nullopt;
}

// Describes a servo whose gain is not above 0; "" for all others.
std::string WrongGain(const DriveLaw& law) {
  if (law.gain_type != mjGAIN_FIXED || law.bias_type != mjBIAS_AFFINE || law.gain > 0) return "";
  const bool of_positions = law.bias[1] == -law.gain;
  if (!of_positions && (law.bias[1] != 0 || law.bias[2] != -law.gain)) return "";
  return fmt::format("a servo with {} {:g}, which {}", of_positions ? "kp" : "kv", law.gain,
                     law.gain < 0 ? "pushes away from its target" : "drives to no target");
}

std::string DescribeLaw(const DriveLaw& law) {
  if (const auto kind = KindOf(law)) return std::string("a ") + ActuatorWord(*kind);
  if (!law.moves) return "without effect, as its gear is 0";
  if (const std::string wrong = WrongGain(law); !wrong.empty()) return wrong;
  const bool servo = law.bias_type == mjBIAS_AFFINE && (law.bias[1] < 0 || law.bias[2] < 0);
  if (servo && law.dynamics == mjDYN_INTEGRATOR) return "a servo that integrates its control";
  return "no position servo, velocity servo or motor";
}

// Returns true if it was added for another mode of an arm (control_modes.h), which is switched off:
// it has the name of the mode and comes after the model's own actuators on the joint.
bool IsAdded(const std::vector<JointActuator>& actuators, size_t i) {
  const JointActuator& actuator = actuators[i];
  const auto here = actuators.begin() + static_cast<std::ptrdiff_t>(i);
  return actuator.kind && actuator.name == ModeActuatorName(actuator.joint, *actuator.kind) &&
         std::any_of(actuators.begin(), here,
                     [&](const JointActuator& other) { return other.joint == actuator.joint; });
}

// Finds the first of the model's own actuators of a kind on each joint.
ArmDrive FindOfKind(CtrlMode kind, const std::vector<std::string>& joints,
                    const std::vector<JointActuator>& actuators) {
  ArmDrive drive{.kind = kind, .names = std::vector<std::string>(joints.size())};
  for (size_t i = 0; i < actuators.size(); ++i) {
    if (actuators[i].kind != kind || IsAdded(actuators, i)) continue;
    for (size_t j = 0; j < joints.size(); ++j) {
      if (joints[j] == actuators[i].joint && drive.names[j].empty())
        drive.names[j] = actuators[i].name;
    }
  }
  return drive;
}

}  // namespace

std::optional<CtrlMode> ActuatorKind(const mjModel* model, int actuator) {
  return KindOf(LawOf(model, actuator));
}

std::optional<CtrlMode> ActuatorKind(const mjsActuator* actuator) {
  return KindOf(LawOf(actuator));
}

std::optional<CtrlMode> ActuatorForceKind(const mjModel* model, int actuator) {
  return KindOfForce(LawOf(model, actuator));
}

bool ActsOnJoint(const mjsActuator* actuator) { return IsOnJoint(actuator->trntype); }

std::string DescribeActuator(const mjModel* model, int actuator) {
  return DescribeLaw(LawOf(model, actuator));
}

std::string DescribeActuator(const mjsActuator* actuator) { return DescribeLaw(LawOf(actuator)); }

const char* ActuatorWord(CtrlMode kind) {
  switch (kind) {
    case CtrlMode::kPosition:
      return "position servo";
    case CtrlMode::kVelocity:
      return "velocity servo";
    case CtrlMode::kTorque:
      break;
  }
  return "motor";
}

std::vector<JointActuator> JointActuators(const mjModel* m) {
  std::vector<JointActuator> out;
  for (int a = 0; a < m->nactuator; ++a) {
    if (!ActsOnJoint(m, a)) continue;
    out.push_back({ElementName(m, mjOBJ_JOINT, m->actuator_trnid[2 * a]),
                   ElementName(m, mjOBJ_ACTUATOR, a), ActuatorKind(m, a)});
  }
  return out;
}

std::vector<JointActuator> JointActuators(const mjSpec* spec) {
  std::vector<JointActuator> out;
  for (mjsElement* element : SpecElements(spec, mjOBJ_ACTUATOR)) {
    const mjsActuator* actuator = mjs_asActuator(element);
    if (!ActsOnJoint(actuator)) continue;
    out.push_back({mjs_getString(actuator->target), SpecName(element), ActuatorKind(actuator)});
  }
  return out;
}

bool ArmDrive::complete() const {
  return kind && std::find(names.begin(), names.end(), "") == names.end();
}

ArmDrive FindArmDrive(const std::vector<std::string>& joints,
                      const std::vector<JointActuator>& actuators) {
  ArmDrive best{.names = std::vector<std::string>(joints.size())};
  const auto missing = [](const ArmDrive& drive) {
    return std::count(drive.names.begin(), drive.names.end(), "");
  };
  for (const CtrlMode kind : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    ArmDrive found = FindOfKind(kind, joints, actuators);
    if (missing(found) < missing(best)) best = std::move(found);
  }
  return best;
}

}  // namespace robocell::internal
