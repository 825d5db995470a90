#include "robocell/robot/joint_position_controller.h"

#include <algorithm>
#include <limits>

#include "robocell/robot/gripper_opening_controller.h"

namespace robocell {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

}  // namespace

std::unique_ptr<Controller> MakeJointPositionController(MoveGroup& group) {
  if (auto* gripper = dynamic_cast<GripperGroup*>(&group)) {
    return std::make_unique<GripperOpeningController>(*gripper);
  }
  return std::make_unique<JointPositionController>(group);
}

JointPositionController::JointPositionController(MoveGroup& group)
    : group_(group),
      target_(group.joint_pos()),
      within_(target_.size()),
      limits_(group.joint_pos_limits()) {
  limits_.resize(target_.size(), Interval{-kUnlimited, kUnlimited});
  std::vector<double> ctrl(group.nu());
  for (size_t i = 0; i < target_.size(); ++i)  // nobody has commanded it yet: not a word
    within_[i] = std::clamp(target_[i], limits_[i].lower, limits_[i].upper);
  group.CtrlForJointPos(within_, ctrl);  // says at once when the group has no servos
}

void JointPositionController::SetTarget(std::span<const double> target) {
  CheckValues([&] { return group_.place(); }, "joint", target, target_size(), group_.joint_names());
  std::copy(target.begin(), target.end(), target_.begin());
}

void JointPositionController::Compute(std::span<double> ctrl) {
  // The port is written to without a check.
  CheckValues([&] { return group_.place(); }, "joint", target_, target_size(),
              group_.joint_names());
  for (size_t i = 0; i < target_.size(); ++i) {
    within_[i] = beyond_.Clamp(target_[i], limits_[i], [&] {
      const std::vector<std::string>& names = group_.joint_names();
      return group_.place() + ": joint " +
             (names.size() == target_.size() ? "'" + names[i] + "'" : std::to_string(i));
    });
  }
  group_.CtrlForJointPos(within_, ctrl);
}

}  // namespace robocell
