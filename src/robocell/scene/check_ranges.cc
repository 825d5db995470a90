// Ranges of joints, servos and noise against each other: what the engine takes without a word and
// is seldom meant.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/check_home.h"
#include "robocell/scene/check_robot.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

constexpr double kMostTurn = 4 * kPi;            // what a hinge's limit may be, rad
constexpr double kLeastTurn = Radians(4 * kPi);  // what 4 pi become that are taken for degrees
constexpr double kDegreesLow = 50, kDegreesHigh = 65;  // around 180 / pi
constexpr double kRangeSlack = 0.02;                   // of a joint's range

struct Reach {
  double lower, upper;
  double width() const { return upper - lower; }
};

std::string Text(const Reach& span) {
  return fmt::format("{:.4g} to {:.4g}", span.lower, span.upper);
}

// The checks of one robot. Names are those of its part.
class RangeCheck {
 public:
  RangeCheck(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
             Report& report)
      : m_(model), home_key_(home_key), robot_(robot), part_(part), report_(report) {}

  void Run() {
    for (const auto& [name, group] : robot_.config.move_groups.entries()) {
      for (const std::string& joint : group->joints) CheckReversed(joint);
      for (const std::string& joint : group->joints) CheckTooFar(joint);
      if (group->kind == MoveGroupKind::kArm && !CheckTooNarrow(*group)) CheckServos(*group);
    }
    CheckActuators();
    for (const auto& [name, noise] : robot_.config.home_noise.entries()) CheckNoise(name, *noise);
  }

 private:
  int Joint(const std::string& name) const {
    const int joint = FindId(m_, mjOBJ_JOINT, robot_.prefix + name);
    const bool single = joint >= 0 && (IsHinge(joint) || m_->jnt_type[joint] == mjJNT_SLIDE);
    return single ? joint : -1;
  }
  bool IsHinge(int joint) const { return m_->jnt_type[joint] == mjJNT_HINGE; }
  Reach RangeOf(int joint) const {
    return {m_->jnt_range[2 * joint], m_->jnt_range[2 * joint + 1]};
  }
  const char* Unit(int joint) const { return IsHinge(joint) ? "rad" : "m"; }

  // The number of the edit that gives the joint its range.
  std::optional<size_t> EditOf(const std::string& joint) const {
    const auto& edits = robot_.config.edits;
    for (size_t i = edits.size(); i-- > 0;) {
      if (!edits[i].joint || !edits[i].range) continue;
      if (edits[i].joint->name == joint || edits[i].name == joint) return i;
    }
    return std::nullopt;
  }

  // At the edit that gives the joint its range, else where the model has the joint.
  void WarnOfJoint(const std::string& joint, const std::string& message) {
    if (const auto edit = EditOf(joint))
      return report_.Warn(part_.place, message, fmt::format("edits[{}].range", *edit));
    report_.WarnAt(PlaceInModel(part_, mjOBJ_JOINT, joint), part_.place, message);
  }

  // Without `limited` the engine then takes the joint as one without limits.
  void CheckReversed(const std::string& name) {
    const int joint = Joint(name);
    if (joint < 0 || m_->jnt_limited[joint]) return;
    const Reach range = RangeOf(joint);
    if (range.lower <= range.upper) return;
    WarnOfJoint(name, fmt::format("the range of joint '{}', {}, has the larger number first, so it "
                                  "limits nothing: write \"{:.4g} {:.4g}\"",
                                  name, Text(range), range.upper, range.lower));
  }

  void CheckTooFar(const std::string& name) {
    const int joint = Joint(name);
    if (joint < 0 || !IsHinge(joint) || !m_->jnt_limited[joint]) return;
    const Reach range = RangeOf(joint);
    const double farthest = std::max(std::abs(range.lower), std::abs(range.upper));
    if (farthest <= kMostTurn + kLimitSlack) return;
    const std::string meant =
        EditOf(name) ? fmt::format("an edit's `range` is in radians: [{:.4f}, {:.4f}]",
                                   Radians(range.lower), Radians(range.upper))
                     : fmt::format(
                           "the model says <compiler angle=\"radian\"/>; {:.4g} degrees "
                           "are {:.4f}",
                           farthest, Radians(farthest));
    WarnOfJoint(name, fmt::format("joint '{}' may turn from {} rad, {:.0f} times around. Are these "
                                  "degrees? Then: {}",
                                  name, Text(range), range.width() / (2 * kPi), meant));
  }

  // Where a servo can send its joint; unset without limits.
  std::optional<Reach> ServoSpan(int actuator) const {
    const int input = m_->actuator_ctrladr[actuator];
    const mjtNum gear = Gear(actuator);
    if (!IsPositionServo(m_, actuator) || !m_->actuator_ctrllimited[input] || gear == 0)
      return std::nullopt;
    const mjtNum* range = m_->actuator_ctrlrange + 2 * input;
    const double a = JointPos(actuator, range[0]), b = JointPos(actuator, range[1]);
    return Reach{std::min(a, b), std::max(a, b)};
  }
  double Gear(int actuator) const { return m_->actuator_gear[6 * m_->actuator_outadr[actuator]]; }
  double JointPos(int actuator, double ctrl) const {
    const mjtNum* bias = m_->actuator_biasprm + mjNBIAS * actuator;
    const mjtNum gain = m_->actuator_gainprm[mjNGAIN * actuator];
    return -(gain * ctrl + bias[0]) / bias[1] / Gear(actuator);
  }
  double Ctrl(int actuator, double joint_pos) const {
    const mjtNum* bias = m_->actuator_biasprm + mjNBIAS * actuator;
    const mjtNum gain = m_->actuator_gainprm[mjNGAIN * actuator];
    return (-bias[1] * Gear(actuator) * joint_pos - bias[0]) / gain;
  }

  bool Drives(int actuator, int joint) const {
    const int type = m_->actuator_trntype[actuator];
    return (type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT) &&
           m_->actuator_trnid[2 * actuator] == joint && IsPositionServo(m_, actuator);
  }

  // The servo of an arm's joint; -1 when it has none.
  int ServoOf(int joint) const {
    for (int a = 0; a < m_->nactuator; ++a) {
      if (Drives(a, joint)) return a;
    }
    return -1;
  }

  // Radians that were read as degrees: all hinges of an arm move next to nothing. One alone may be
  // meant so, unless its servo says otherwise.
  bool CheckTooNarrow(const MoveGroupConfig& arm) {
    int hinges = 0, widest = -1, telling = -1;
    for (const std::string& name : arm.joints) {
      const int joint = Joint(name);
      if (joint < 0 || !IsHinge(joint) || !m_->jnt_limited[joint]) continue;
      if (RangeOf(joint).width() > kLeastTurn) return false;
      ++hinges;
      if (widest < 0 || RangeOf(joint).width() > RangeOf(widest).width()) widest = joint;
      if (IsInDegrees(joint)) telling = joint;
    }
    if (hinges == 0 || (hinges < 2 && telling < 0)) return false;
    const int joint = telling >= 0 ? telling : widest;
    const std::string name = Name(mjOBJ_JOINT, joint);
    const std::string servo =
        telling < 0 ? ""
                    : fmt::format(", while its servo takes {}", Text(*ServoSpan(ServoOf(joint))));
    report_.WarnAt(
        PlaceInModel(part_, mjOBJ_JOINT, name), part_.place,
        fmt::format("no hinge of the arm moves farther than {:.1f} degrees (joint '{}': "
                    "{} rad{}). Were radians read as degrees? They are degrees unless "
                    "the model says <compiler angle=\"radian\"/>",
                    RangeOf(widest).width() * 180 / kPi, name, Text(RangeOf(joint)), servo));
    return true;
  }

  // Whether the joint's range looks like its servo's, divided by 180 / pi.
  bool IsInDegrees(int joint) const {
    const int servo = ServoOf(joint);
    const auto span = servo < 0 ? std::nullopt : ServoSpan(servo);
    const double times = span ? span->width() / RangeOf(joint).width() : 0;
    return times > kDegreesLow && times < kDegreesHigh;
  }

  void CheckServos(const MoveGroupConfig& arm) {
    for (const std::string& name : arm.joints) {
      const int joint = Joint(name);
      const int servo = joint < 0 || !m_->jnt_limited[joint] ? -1 : ServoOf(joint);
      if (servo >= 0) CheckServo(name, joint, servo);
    }
  }

  void CheckServo(const std::string& name, int joint, int servo) {
    const std::optional<Reach> span = ServoSpan(servo);
    const Reach range = RangeOf(joint);
    const double slack = kRangeSlack * range.width();
    if (!span || range.upper > kMostTurn + kLimitSlack) return;  // CheckTooFar says more
    if (span->lower <= range.lower + slack && span->upper >= range.upper - slack) return;
    const std::string actuator = Name(mjOBJ_ACTUATOR, servo);
    const bool apart = span->upper < range.lower || span->lower > range.upper;
    double low = Ctrl(servo, range.lower), high = Ctrl(servo, range.upper);
    if (low > high) std::swap(low, high);
    report_.WarnAt(
        PlaceInModel(part_, mjOBJ_ACTUATOR, actuator), part_.place,
        fmt::format("the servo '{}' sends joint '{}' from {} {} (its ctrlrange), but the joint may "
                    "move from {} {}: {}{}. To use all of it: edits: [{{actuator: '{}', ctrlrange: "
                    "[{:.4g}, {:.4g}]}}]",
                    actuator, name, Text(*span), Unit(joint), Text(range), Unit(joint),
                    apart ? "it is driven against its limit" : "commands beyond stop there",
                    HomeBeyond(joint, *span, slack), actuator, low, high));
  }

  std::string HomeBeyond(int joint, const Reach& span, double slack) const {
    const double home = m_->key_qpos[home_key_ * m_->nq + m_->jnt_qposadr[joint]];
    if (home >= span.lower - slack && home <= span.upper + slack) return "";
    return fmt::format(", and so does the way to home, {:.4g}", home);
  }

  // Control and force ranges with the larger number first limit nothing either.
  void CheckActuators() {
    for (int a = 0; a < m_->nactuator; ++a) {
      const std::string full = ElementName(m_, mjOBJ_ACTUATOR, a);
      if (!full.starts_with(robot_.prefix)) continue;
      if (!FindSpecElement(part_.spec.get(), mjOBJ_ACTUATOR, full.substr(robot_.prefix.size())))
        continue;  // of something else, with an empty prefix
      const int input = m_->actuator_ctrladr[a];
      if (m_->actuator_ctrlnum[a] > 0 && !m_->actuator_ctrllimited[input])
        WarnReversed(a, "ctrlrange", m_->actuator_ctrlrange + 2 * input);
      if (!m_->actuator_forcelimited[a])
        WarnReversed(a, "forcerange", m_->actuator_forcerange + 2 * a);
    }
  }

  void WarnReversed(int actuator, const char* attribute, const mjtNum* range) {
    if (range[0] <= range[1]) return;
    const std::string name = Name(mjOBJ_ACTUATOR, actuator);
    report_.WarnAt(PlaceInModel(part_, mjOBJ_ACTUATOR, name), part_.place,
                   fmt::format("the {} of actuator '{}', {}, has the larger number first, so it "
                               "limits nothing: write \"{:.4g} {:.4g}\"",
                               attribute, name, Text({range[0], range[1]}), range[1], range[0]));
  }

  // A gripper at home is at one end of its range, where noise is cut off by intention.
  void CheckNoise(const std::string& group_name, const std::vector<double>& noise) {
    const MoveGroupConfig* group = robot_.config.move_groups.find(group_name);
    if (!group || noise.empty()) return;
    const bool at_end = group->kind == MoveGroupKind::kGripper;
    for (size_t i = 0; i < group->joints.size(); ++i) {
      const int joint = Joint(group->joints.names[i]);
      const double amount = noise.size() == 1 ? noise[0] : i < noise.size() ? noise[i] : 0;
      if (joint < 0 || !m_->jnt_limited[joint]) continue;
      const Reach range = RangeOf(joint);
      const double home = m_->key_qpos[home_key_ * m_->nq + m_->jnt_qposadr[joint]];
      const double room = std::max(std::min(home - range.lower, range.upper - home), 0.0);
      if (amount <= (at_end ? range.width() : room) + kLimitSlack) continue;
      return report_.Warn(
          part_.place,
          fmt::format("home_noise.{}: {:g} {} around home, {:.4g}, leaves the range of joint '{}', "
                      "{}: what is beyond is put at its limit. Up to {:.4g} stays inside",
                      group_name, amount, Unit(joint), home, group->joints.names[i], Text(range),
                      at_end ? range.width() : room),
          "home_noise." + group_name);
    }
  }

  std::string Name(mjtObj kind, int id) const {
    return ElementName(m_, kind, id).substr(robot_.prefix.size());
  }

  const mjModel* m_;
  int home_key_;
  const RobotRecord& robot_;
  const Part& part_;
  Report& report_;
};

}  // namespace

void CheckRanges(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
                 Report& report) {
  RangeCheck(model, home_key, robot, part, report).Run();
}

}  // namespace robocell
