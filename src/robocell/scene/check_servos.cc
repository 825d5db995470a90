// Where an arm's servos can send its joints, against home and the joints' ranges. A servo that
// stops short of its joint is meant so more often than not: that is a note.
#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/names.h"
#include "robocell/base/units.h"
#include "robocell/scene/check_robot.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/joint_ranges.h"

namespace robocell {
namespace {

constexpr double kServoSlack = 0.02;               // of a joint's range
constexpr double kHardlyAny = 0.05;                // of a joint's range: no safety margin
constexpr double kHardlyTurns = Radians(4 * kPi);  // what 4 pi become that are taken for degrees

class ServoCheck {
 public:
  ServoCheck(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
             Report& report)
      : m_(model), home_key_(home_key), ranges_(model, robot, part), part_(part), report_(report) {}

  void Run(const std::string& name, const MoveGroupConfig& arm) {
    for (const std::string& joint_name : arm.joints) {
      const int joint = ranges_.Joint(joint_name);
      if (joint < 0 || !m_->jnt_limited[joint]) continue;
      const int servo = ranges_.ServoOf(arm, joint);
      if (const auto span = ranges_.ServoSpan(servo)) Check(joint, servo, *span);
    }
    if (short_.empty()) return;
    report_.Note(part_.place, fmt::format("servos of '{}' stop before their joints do (their "
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
    report_.WarnAt(
        PlaceInModel(part_, mjOBJ_ACTUATOR, name), part_.place,
        fmt::format("the servo '{}' sends joint '{}' from {} {} (its ctrlrange), but the joint may "
                    "move from {} {}: {}. To use all of it: edits: [{{actuator: '{}', ctrlrange: "
                    "[{:.4g}, {:.4g}]}}]",
                    name, ranges_.Name(mjOBJ_JOINT, joint), span.text(), unit, range.text(), unit,
                    so, name, low, high));
  }

  const mjModel* m_;
  int home_key_;
  const JointRanges ranges_;
  const Part& part_;
  Report& report_;
  std::vector<std::string> short_;
};

bool IsOfPositions(const RobotConfig& config, const std::string& group) {
  const ControlKind* control = config.control.find(group);
  return !control || ModeOf(*control) == CtrlMode::kPosition;
}

}  // namespace

void CheckServos(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
                 Report& report) {
  for (const auto& [name, group] : robot.config.move_groups.entries()) {
    if (group->kind == MoveGroupKind::kArm && IsOfPositions(robot.config, name))
      ServoCheck(model, home_key, robot, part, report).Run(name, *group);
  }
}

}  // namespace robocell
