// Compares ranges of joints and noise with each other: values that the engine accepts silently and
// that are seldom intended. servos.cc has the servos.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/inspection/joint_ranges.h"
#include "robocell/scene/inspection/robot_inspection.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/validate_keyframes.h"

namespace robocell::internal {
namespace {

constexpr double kMostTurn = 4 * kPi;                  // the largest limit of a hinge, rad
constexpr double kLeastTurn = Radians(4 * kPi);        // 4 pi taken for degrees
constexpr double kDegreesLow = 50, kDegreesHigh = 65;  // around 180 / pi
constexpr double kAsFar = 0.5;                         // share of a joint's range
constexpr double kWholeTurns = 720;                    // the largest number of degrees of a joint
constexpr double kHardlyCoupled = 0.05;  // share of the narrower of two coupled ranges

// The checks of one robot. Names are those of its part.
class RangeCheck {
 public:
  RangeCheck(const CompiledRobot& robot, Findings& findings)
      : m_(robot.model),
        home_key_(robot.home_key),
        ranges_(robot),
        robot_(robot.robot),
        part_(robot.part),
        findings_(findings) {}

  void Run() {
    for (const auto& [name, group] : robot_.config.move_groups.entries()) {
      for (const std::string& joint : group->joints) CheckReversed(joint);
      for (const std::string& joint : group->joints) CheckTooFar(*group, joint);
      if (group->kind == MoveGroupKind::kArm || group->kind == MoveGroupKind::kGripper)
        CheckTooNarrow(*group);
      if (group->kind == MoveGroupKind::kArm) CheckOneTooNarrow(*group);
    }
    CheckActuators();
    CheckCouplings();
    for (const auto& [name, noise] : robot_.config.home_noise.entries()) CheckNoise(name, *noise);
  }

 private:
  // Returns the number of the edit that gives the joint its range.
  std::optional<size_t> EditOf(const std::string& joint) const {
    const auto& edits = robot_.config.edits;
    for (size_t i = edits.size(); i-- > 0;) {
      if (!edits[i].joint || !edits[i].range) continue;
      if (edits[i].joint->name == joint || edits[i].name == joint) return i;
    }
    return std::nullopt;
  }

  // Warns at the edit that gives the joint its range, else at the joint in the model.
  void WarnOfJoint(const std::string& joint, const std::string& message) {
    if (const auto edit = EditOf(joint))
      return findings_.Warn(fmt::format("edits[{}].range", *edit), message);
    findings_.WarnAt(PlaceInModel(part_, mjOBJ_JOINT, joint), message);
  }

  // Without `limited` the engine then treats the joint as unlimited.
  void CheckReversed(const std::string& name) {
    const int joint = ranges_.Joint(name);
    if (joint < 0 || m_->jnt_limited[joint]) return;
    const Reach range = ranges_.RangeOf(joint);
    if (range.lower <= range.upper) return;
    WarnOfJoint(name, fmt::format("the range of joint '{}', {}, has the larger number first, so it "
                                  "limits nothing: write \"{:.4g} {:.4g}\"",
                                  name, range.text(), range.upper, range.lower));
  }

  // Some joints do turn that far: a winch, whose servo does too, or an endless wheel.
  void CheckTooFar(const MoveGroupConfig& group, const std::string& name) {
    const int joint = ranges_.Joint(name);
    if (joint < 0 || !ranges_.IsHinge(joint) || !m_->jnt_limited[joint]) return;
    const Reach range = ranges_.RangeOf(joint);
    const double farthest = std::max(std::abs(range.lower), std::abs(range.upper));
    if (farthest <= kMostTurn + kLimitSlack || farthest > kWholeTurns + kLimitSlack) return;
    if (ServoTurnsAsFar(group, joint)) return;
    const std::string meant =
        EditOf(name)
            ? fmt::format("Then: an edit's `range` is in radians: [{:.4f}, {:.4f}]",
                          Radians(range.lower), Radians(range.upper))
            : fmt::format(
                  "Then write radians ({:.4g} degrees are {:.4f}), or leave angle=\"radian\" "
                  "out of the model's <compiler>",
                  farthest, Radians(farthest));
    WarnOfJoint(name, fmt::format("joint '{}' may turn from {} rad, {:.0f} times around. Are these "
                                  "degrees? {}",
                                  name, range.text(), range.width() / (2 * kPi), meant));
  }

  // Returns true if the joint's servo has nearly the same range.
  bool ServoTurnsAsFar(const MoveGroupConfig& group, int joint) const {
    const int servo = ranges_.ServoOf(group, joint);
    const auto span = ranges_.ServoSpan(servo);
    if (!span || span->width() < kAsFar * ranges_.RangeOf(joint).width()) return false;
    const std::string name = ranges_.Name(mjOBJ_ACTUATOR, servo);
    mjsElement* element = FindSpecElement(part_.spec.get(), mjOBJ_ACTUATOR, name);
    return !element || mjs_asActuator(element)->inheritrange == 0;  // no effect here
  }

  // Finds radians that were read as degrees: all hinges of an arm move hardly at all. A single one
  // may be intended, unless its servo contradicts it; so may those of fingers.
  void CheckTooNarrow(const MoveGroupConfig& group) {
    const bool arm = group.kind == MoveGroupKind::kArm;
    int hinges = 0, widest = -1, in_degrees = -1;
    for (const std::string& name : group.joints) {
      const int joint = ranges_.Joint(name);
      if (joint < 0 || !ranges_.IsHinge(joint) || !m_->jnt_limited[joint]) continue;
      if (ranges_.RangeOf(joint).width() > kLeastTurn) return;
      ++hinges;
      if (widest < 0 || ranges_.RangeOf(joint).width() > ranges_.RangeOf(widest).width())
        widest = joint;
      if (IsInDegrees(group, joint)) in_degrees = joint;
    }
    if (hinges == 0 || ((hinges < 2 || !arm) && in_degrees < 0)) return;
    const int joint = in_degrees >= 0 ? in_degrees : widest;
    const std::string name = ranges_.Name(mjOBJ_JOINT, joint);
    const auto span = ranges_.ServoSpan(ranges_.ServoOf(group, joint));
    const std::string servo =
        in_degrees < 0 || !span ? "" : fmt::format(", while its servo takes {}", span->text());
    findings_.WarnAt(
        PlaceInModel(part_, mjOBJ_JOINT, name),
        fmt::format("no hinge of the {} moves farther than {:.1f} degrees (joint '{}': "
                    "{} rad{}). Were radians read as degrees? They are degrees unless "
                    "the model says <compiler angle=\"radian\"/>",
                    arm ? "arm" : "gripper", ranges_.RangeOf(widest).width() * 180 / kPi, name,
                    ranges_.RangeOf(joint).text(), servo));
  }

  // Finds one hinge that moves hardly at all in an arm whose other hinges move, in a model in
  // degrees: its numbers are small enough to be radians.
  void CheckOneTooNarrow(const MoveGroupConfig& arm) {
    if (!part_.spec->compiler.degree) return;
    std::vector<int> narrow;
    bool others_move = false;
    for (const std::string& name : arm.joints) {
      const int joint = ranges_.Joint(name);
      if (joint < 0 || !ranges_.IsHinge(joint)) continue;
      if (m_->jnt_limited[joint] && ranges_.RangeOf(joint).width() <= kLeastTurn) {
        if (!EditOf(name)) narrow.push_back(joint);
      } else {
        others_move = true;
      }
    }
    if (!others_move) return;
    for (const int joint : narrow) {
      const Reach range = ranges_.RangeOf(joint);
      const double lower = range.lower * 180 / kPi, upper = range.upper * 180 / kPi;
      const std::string name = ranges_.Name(mjOBJ_JOINT, joint);
      WarnOfJoint(
          name,
          fmt::format("joint '{}' moves from {:.4g} to {:.4g} degrees only, while "
                      "other hinges of the arm move farther. Are these radians? The model's angles "
                      "are degrees: write \"{:.4g} {:.4g}\", or, if they are correct, leave it",
                      name, lower, upper, lower * 180 / kPi, upper * 180 / kPi));
    }
  }

  // Finds an equality that only lets a joint go where the other one may not.
  void CheckCouplings() {
    for (int e = 0; e < m_->neq; ++e) {
      const int first = m_->eq_obj1id[e], second = m_->eq_obj2id[e];
      if (m_->eq_type[e] != mjEQ_JOINT || !m_->eq_active0[e] || second < 0) continue;
      if (m_->jnt_limited[first] && m_->jnt_limited[second] && IsOwn(first) && IsOwn(second))
        CheckCoupling(first, second, m_->eq_data + mjNEQDATA * e);
    }
  }

  // With an empty prefix the joint may belong to another part.
  bool IsOwn(int joint) const {
    const std::string full = ElementName(m_, mjOBJ_JOINT, joint);
    return full.starts_with(robot_.prefix) &&
           FindSpecElement(part_.spec.get(), mjOBJ_JOINT, full.substr(robot_.prefix.size()));
  }

  void CheckCoupling(int first, int second, const mjtNum* polynomial) {
    const Reach range = ranges_.RangeOf(first);
    const double least = kHardlyCoupled * range.width();
    const Reach to = Coupled(first, second, polynomial, 1);
    if (Shared(to, range) >= std::min(least, kHardlyCoupled * to.width()) || to.width() <= 0)
      return;
    const Reach turned = Coupled(first, second, polynomial, -1);
    const std::string name = ranges_.Name(mjOBJ_JOINT, first);
    const std::string other = ranges_.Name(mjOBJ_JOINT, second);
    findings_.WarnAt(
        PlaceInModel(part_, mjOBJ_JOINT, name),
        fmt::format(
            "the equality of joints '{0}' and '{1}' sends '{0}' from {2} {3} while '{1}' moves "
            "through its range, {4}, but '{0}' may move from {5}, so neither moves. {6}",
            name, other, to.text(), ranges_.Unit(first), ranges_.RangeOf(second).text(),
            range.text(),
            Shared(turned, range) > least
                ? fmt::format("Has its polycoef the wrong sign? \"{:g} {:g}\" would fit",
                              polynomial[0], 0.0 - polynomial[1])
                : std::string("Are its polycoef and the ranges right?")));
  }

  // Returns the positions of the first joint while the second moves through its range; `sign` is
  // that of the polynomial beyond its constant.
  Reach Coupled(int first, int second, const mjtNum* polynomial, double sign) const {
    constexpr int kParts = 50;
    const Reach range = ranges_.RangeOf(second);
    const double from = m_->qpos0[m_->jnt_qposadr[second]];
    const double zero = m_->qpos0[m_->jnt_qposadr[first]];
    Reach out{HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i <= kParts; ++i) {
      const double x = range.lower + range.width() * i / kParts - from;
      const double rest = ((polynomial[4] * x + polynomial[3]) * x + polynomial[2]) * x;
      const double y = zero + polynomial[0] + sign * (rest + polynomial[1]) * x;
      out = {std::min(out.lower, y), std::max(out.upper, y)};
    }
    return out;
  }

  static double Shared(const Reach& a, const Reach& b) {
    return std::min(a.upper, b.upper) - std::max(a.lower, b.lower);
  }

  // Returns true if the joint's range looks like its servo's, divided by 180 / pi.
  bool IsInDegrees(const MoveGroupConfig& group, int joint) const {
    const auto span = ranges_.ServoSpan(ranges_.ServoOf(group, joint));
    const double times = span ? span->width() / ranges_.RangeOf(joint).width() : 0;
    return times > kDegreesLow && times < kDegreesHigh;
  }

  // Control and force ranges with the larger number first do not limit anything either.
  void CheckActuators() {
    for (int a = 0; a < m_->nactuator; ++a) {
      const std::string full = ElementName(m_, mjOBJ_ACTUATOR, a);
      if (!full.starts_with(robot_.prefix)) continue;
      if (!FindSpecElement(part_.spec.get(), mjOBJ_ACTUATOR, full.substr(robot_.prefix.size())))
        continue;  // belongs to another part, with an empty prefix
      const int input = m_->actuator_ctrladr[a];
      if (m_->actuator_ctrlnum[a] > 0 && !m_->actuator_ctrllimited[input])
        WarnReversed(a, "ctrlrange", m_->actuator_ctrlrange + 2 * input);
      if (!m_->actuator_forcelimited[a])
        WarnReversed(a, "forcerange", m_->actuator_forcerange + 2 * a);
    }
  }

  void WarnReversed(int actuator, const char* attribute, const mjtNum* range) {
    if (range[0] <= range[1]) return;
    const std::string name = ranges_.Name(mjOBJ_ACTUATOR, actuator);
    findings_.WarnAt(
        PlaceInModel(part_, mjOBJ_ACTUATOR, name),
        fmt::format("the {} of actuator '{}', {}, has the larger number first, so it "
                    "limits nothing: write \"{:.4g} {:.4g}\"",
                    attribute, name, Reach{range[0], range[1]}.text(), range[1], range[0]));
  }

  // A gripper at home is at one end of its range, where noise is clipped on purpose.
  void CheckNoise(const std::string& group_name, const std::vector<double>& noise) {
    const MoveGroupConfig* group = robot_.config.move_groups.find(group_name);
    if (!group || noise.empty()) return;
    const bool at_end = group->kind == MoveGroupKind::kGripper;
    for (size_t i = 0; i < group->joints.size(); ++i) {
      const int joint = ranges_.Joint(group->joints.names[i]);
      const double amount = noise.size() == 1 ? noise[0] : i < noise.size() ? noise[i] : 0;
      if (joint < 0 || !m_->jnt_limited[joint]) continue;
      const Reach range = ranges_.RangeOf(joint);
      const double home = m_->key_qpos[home_key_ * m_->nq + m_->jnt_qposadr[joint]];
      const double room = std::max(std::min(home - range.lower, range.upper - home), 0.0);
      if (amount <= (at_end ? range.width() : room) + kLimitSlack) continue;
      return findings_.Warn(
          "home_noise." + group_name,
          fmt::format("home_noise.{}: {:g} {} around home, {:.4g}, leaves the range of joint '{}', "
                      "{}: larger values are clipped to the limit. Up to {:.4g} stays inside",
                      group_name, amount, ranges_.Unit(joint), home, group->joints.names[i],
                      range.text(), at_end ? range.width() : room));
    }
  }

  const mjModel* m_;
  int home_key_;
  const JointRanges ranges_;
  const RobotRecord& robot_;
  const Part& part_;
  Findings& findings_;
};

}  // namespace

void CheckRanges(const CompiledRobot& robot, Findings& findings) {
  RangeCheck(robot, findings).Run();
}

}  // namespace robocell::internal
