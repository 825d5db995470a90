#include "robocell/robot/joint_position_controller.h"

#include <algorithm>

#include "robocell/robot/gripper_opening_controller.h"

namespace robocell {

std::unique_ptr<Controller> MakeJointPositionController(MoveGroup& group) {
  if (auto* gripper = dynamic_cast<GripperGroup*>(&group)) {
    return std::make_unique<GripperOpeningController>(*gripper);
  }
  return std::make_unique<JointPositionController>(group);
}

JointPositionController::JointPositionController(MoveGroup& group)
    : group_(group), target_(group.joint_pos()) {
  std::vector<double> ctrl(group.nu());
  group.CtrlForJointPos(target_, ctrl);  // says at once when the group has no servos
}

void JointPositionController::SetTarget(std::span<const double> target) {
  CheckValues([&] { return group_.place(); }, "joint", target, target_size(), group_.joint_names());
  std::copy(target.begin(), target.end(), target_.begin());
}

}  // namespace robocell
