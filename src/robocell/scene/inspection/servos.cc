// Compares the range of each servo with home and the joint's range. A servo that ends before its
// joint's limit is usually intended: that is a note. One that goes far beyond was given degrees:
// the engine converts joints' ranges, and never controls. Also finds servos that cannot damp their
// joints at their force limit, and those whose force limits allow one direction only.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/control_modes.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/inspection/joint_ranges.h"
#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {
namespace {

constexpr double kHardlyAny = 0.05;  // share of a joint's range: no safety margin
constexpr double kManyTimes = 20;    // a joint's range; degrees are 57 times
constexpr double kManyTurns = 4 * kPi;
// See CheckDampingAtTheLimit. The Panda of the Menagerie has 4.1, where a motion of 0.2 mrad
// remains; its Gen3 has 7.8 to 148, and swings with 200 rad/s.
constexpr double kJumpsOver = 5;
constexpr double kTooSlow = 100;                   // a servo's time constant, seconds
constexpr double kHardlyTurns = Radians(4 * kPi);  // 4 pi taken for degrees

class ServoCheck {
 public:
  ServoCheck(const CompiledRobot& robot, Findings& findings)
      : m_(robot.model),
        home_key_(robot.home_key),
        ranges_(robot),
        part_(robot.part),
        findings_(findings) {}

  void Run(const std::string& name, const MoveGroupConfig& arm) {
    for (const std::string& joint_name : arm.joints) {
      const int joint = ranges_.Joint(joint_name);
      if (joint < 0 || !m_->jnt_limited[joint]) continue;
      const int servo = ranges_.ServoOf(arm, joint);
      if (const auto span = ranges_.ServoSpan(servo)) Check(joint, servo, *span);
    }
    if (short_.empty()) return;
    findings_.Note(
        fmt::format("servos of '{}' stop before their joints do (their "
                    "ctrlrange): {}",
                    name, ListNames(short_, 40)));
  }

 private:
  void Check(int joint, int servo, const Reach& span) {
    const Reach range = ranges_.RangeOf(joint);
    const double slack = kServoSlack * range.width();
    if (span.lower <= range.lower + slack && span.upper >= range.upper - slack) return;
    const double home = m_->key_qpos[home_key_ * m_->nq + m_->jnt_qposadr[joint]];
    const bool without_home = home < span.lower - slack || home > span.upper + slack;
    const bool apart = span.upper < range.lower || span.lower > range.upper;
    const bool hardly = span.width() < kHardlyAny * range.width() &&
                        (!ranges_.IsHinge(joint) || span.width() < kHardlyTurns);
    if (apart || without_home || hardly) {
      Warn(joint, servo, span,
           (apart    ? "it is driven against its limit"
            : hardly ? "it hardly moves"
                     : "commands beyond stop there") +
               (without_home ? fmt::format(", and the way to home, {:.4g}, stops there", home)
                             : std::string()));
    } else {
      short_.push_back(fmt::format("{} {} of {}", ranges_.Name(mjOBJ_ACTUATOR, servo), span.text(),
                                   range.text()));
    }
  }

  void Warn(int joint, int servo, const Reach& span, const std::string& so) {
    const Reach range = ranges_.RangeOf(joint);
    const std::string name = ranges_.Name(mjOBJ_ACTUATOR, servo);
    double low = ranges_.Ctrl(servo, range.lower), high = ranges_.Ctrl(servo, range.upper);
    if (low > high) std::swap(low, high);
    const char* unit = ranges_.Unit(joint);
    const std::string edit =
        fmt::format("{{actuator: '{}', ctrlrange: [{:.4g}, {:.4g}]}}", name, low, high);
    findings_.WarnAt(
        PlaceInModel(part_, mjOBJ_ACTUATOR, name),
        fmt::format("the servo '{}' sends joint '{}' from {} {} (its ctrlrange), but the joint may "
                    "move from {} {}: {}. To use all of it: edits: [{}]",
                    name, ranges_.Name(mjOBJ_JOINT, joint), span.text(), unit, range.text(), unit,
                    so, edit),
        edit);
  }

  const mjModel* m_;
  int home_key_;
  const JointRanges ranges_;
  const Part& part_;
  Findings& findings_;
  std::vector<std::string> short_;
};

// Returns the hinge with a range that a position servo drives; -1 if there is none.
int HingeOf(const mjModel* m, int actuator) {
  if (actuator < 0 || !ActsOnJoint(m, actuator) || !IsPositionServo(m, actuator)) return -1;
  const int joint = m->actuator_trnid[2 * actuator];
  return m->jnt_type[joint] == mjJNT_HINGE && m->jnt_limited[joint] ? joint : -1;
}

// Checks arms and grippers: by default a finger's controls are the ends of this range.
void CheckForDegrees(const CompiledRobot& robot, const MoveGroupConfig& group, Findings& findings) {
  const mjModel* m = robot.model;
  const Part& part = robot.part;
  const JointRanges ranges(robot);
  const bool arm = group.kind == MoveGroupKind::kArm;
  for (const std::string& name :
       arm ? ArmActuators(group, part.spec.get()) : group.actuators.names) {
    const int servo = FindId(m, mjOBJ_ACTUATOR, robot.robot.prefix + name);
    const int joint = HingeOf(m, servo);
    const auto span = joint < 0 ? std::nullopt : ranges.ServoSpan(servo);
    if (!span || span->width() < std::max(kManyTurns, kManyTimes * ranges.RangeOf(joint).width()))
      continue;
    const Reach range = ranges.RangeOf(joint);
    const double a = ranges.Ctrl(servo, range.lower), b = ranges.Ctrl(servo, range.upper);
    const std::string edit = fmt::format("{{actuator: '{}', ctrlrange: [{:.4g}, {:.4g}]}}", name,
                                         std::min(a, b), std::max(a, b));
    findings.WarnAt(
        PlaceInModel(part, mjOBJ_ACTUATOR, name),
        fmt::format("the servo '{}' takes {} rad for joint '{}' (its ctrlrange), which may move "
                    "from {} rad. Are these degrees? The engine converts joints' ranges, never "
                    "ctrlrange: edits: [{}]",
                    name, span->text(), ranges.Name(mjOBJ_JOINT, joint), range.text(), edit),
        edit);
  }
}

// Returns the smallest two-digit number that is not less: 0.05, 0.13.
double RoundedUp(double value) {
  const double digit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / digit - 1e-9) * digit;
}

// The engine takes a servo's damping implicitly, but not while the force is at its limit F. There a
// step dt changes the speed by dt F / M, and the servo damps only within speeds F / kv of its rest
// position. With kv dt / M > 2 a step can jump over all of these, from one limit to the other, and
// back with the next: it does so in a share of 1 - 2 / (kv dt / M) of the speeds. M is the inertia
// at the model's reference.
void CheckDampingAtTheLimit(const CompiledRobot& robot, const std::string& group_name,
                            const MoveGroupConfig& group, Findings& findings) {
  const mjModel* m = robot.model;
  const bool implicit =
      m->opt.integrator == mjINT_IMPLICIT || m->opt.integrator == mjINT_IMPLICITFAST;
  const JointRanges ranges(robot);
  std::vector<std::string> servos, edits;
  for (const std::string& name : group.joints) {
    const int joint = ranges.Joint(name);
    const int servo = joint < 0 ? -1 : ranges.ServoOf(group, joint);
    if (servo < 0 || !implicit || !IsPositionServo(m, servo) || !m->actuator_forcelimited[servo])
      continue;
    const double gear = Gear(m, servo), dt = m->opt.timestep;
    const double kv = -m->actuator_biasprm[mjNBIAS * servo + 2] * gear * gear;
    const int dof = m->jnt_dofadr[joint];
    const double inertia = m->dof_M0[dof];
    if (kv <= 0 || inertia <= 0 || kv * dt <= kJumpsOver * inertia) continue;
    // The trial of the arm names a kv that is a typing error; no armature helps against it.
    const double kp = -m->actuator_biasprm[mjNBIAS * servo + 1] * gear * gear;
    if (kv > kTooSlow * kp) continue;
    servos.push_back(
        fmt::format("{} {:.2g}", ranges.Name(mjOBJ_ACTUATOR, servo), kv * dt / inertia));
    edits.push_back(fmt::format("{{joint: '{}', armature: {:g}}}", ranges.Name(mjOBJ_JOINT, joint),
                                RoundedUp(std::max(kv * dt / 2, m->dof_armature[dof]))));
  }
  if (servos.empty()) return;
  findings.Note(fmt::format(
      "servos of '{}' cannot damp their joints at their force limit with a timestep of {:g} s (kv "
      "dt / inertia, stable up to 2): {}. Targets far ahead make these joints swing from one limit "
      "to the other. Does the model leave out the inertia of the motors? edits: [{}]. A smaller "
      "timestep or a lower kv helps too",
      group_name, m->opt.timestep, fmt::join(servos, ", "), fmt::join(edits, ", ")));
}

// A position servo that can only push or only pull does not hold its joint. Tendons can be pulled
// only, so that such limits make sense there.
void CheckOneSidedForce(const CompiledRobot& robot, const MoveGroupConfig& group,
                        Findings& findings) {
  const mjModel* m = robot.model;
  const JointRanges ranges(robot);
  for (const std::string& name : group.joints) {
    const int joint = ranges.Joint(name);
    const int servo = joint < 0 ? -1 : ranges.ServoOf(group, joint);
    if (servo < 0 || !IsPositionServo(m, servo) || !m->actuator_forcelimited[servo]) continue;
    const mjtNum* range = m->actuator_forcerange + 2 * servo;
    if (range[0] < 0 && range[1] > 0) continue;
    const double most = std::max(std::abs(range[0]), std::abs(range[1]));
    const std::string actuator = ranges.Name(mjOBJ_ACTUATOR, servo);
    const std::string edit =
        fmt::format("{{actuator: '{0}', forcerange: [-{1:.4g}, {1:.4g}]}}", actuator, most);
    const std::string remedy = most > 0 ? fmt::format(". For both directions: edits: [{}]", edit)
                                        : std::string(". Give it the force of its motor");
    findings.WarnAt(
        PlaceInModel(robot.part, mjOBJ_ACTUATOR, actuator),
        fmt::format("the servo '{}' {} (its forcerange, {:g} to {:g}), so it cannot hold joint "
                    "'{}'{}",
                    actuator, most > 0 ? "pushes in one direction only" : "has no force", range[0],
                    range[1], name, remedy),
        most > 0 ? edit : "");
  }
}

bool IsOfPositions(const RobotConfig& config, const std::string& group) {
  const ControlKind* control = config.control.find(group);
  return !control || ModeOf(*control) == CtrlMode::kPosition;
}

}  // namespace

void CheckServos(const CompiledRobot& robot, Findings& findings) {
  const RobotConfig& config = robot.robot.config;
  for (const auto& [name, group] : config.move_groups.entries()) {
    CheckForDegrees(robot, *group, findings);
    if (group->kind != MoveGroupKind::kArm || !IsOfPositions(config, name)) continue;
    ServoCheck(robot, findings).Run(name, *group);
    CheckDampingAtTheLimit(robot, name, *group, findings);
    CheckOneSidedForce(robot, *group, findings);
  }
}

}  // namespace robocell::internal
