#include "robocell/control/relative_joint_controller.h"

#include <algorithm>

#include "robocell/robot/move_group.h"

namespace robocell {
namespace {

[[maybe_unused]] const bool kRegistered = [] {
  RegisterController("relative_joint_position",
                     [](MoveGroup& group) -> std::unique_ptr<Controller> {
                       return std::make_unique<RelativeJointController>(group);
                     });
  return true;
}();

}  // namespace

void RelativeJointController::SetTarget(std::span<const double> delta) {
  RequireValues([&] { return group_.place(); }, "joint", delta, target_size(),
                group_.joint_names());
  const std::vector<Interval> limits = CheckedJointPosLimits(group_);
  const std::span<double> target = absolute_.command_port();
  for (size_t i = 0; i < target.size(); ++i) {
    target[i] = std::clamp(target[i] + delta[i], limits[i].lower, limits[i].upper);
    delta_[i] = delta[i];
  }
}

void RelativeJointController::Reset() {
  absolute_.Reset();
  std::fill(delta_.begin(), delta_.end(), 0.0);
}

void RelativeJointController::ResetTo(std::span<const double> servos) {
  absolute_.ResetTo(servos);
  std::fill(delta_.begin(), delta_.end(), 0.0);
}

}  // namespace robocell
