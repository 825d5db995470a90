#include "robocell/robot/base_pose_controller.h"

#include "robocell/base/error.h"

namespace robocell::internal {

std::unique_ptr<Controller> MakeBasePoseController(MoveGroup& group) {
  if (auto* base = dynamic_cast<DrivenBase*>(&group))
    return std::make_unique<BasePoseController>(*base);
  throw ArgumentError(group.place() +
                      ": the controller 'base_pose' drives a driven base only; give the robot "
                      "`base: {kind: driven}`");
}

void BasePoseController::SetTarget(std::span<const double> n) {
  RequireValues([&] { return base_.place(); }, "pose", n, 7);
  try {
    base_.SetTarget(Pose({n[0], n[1], n[2]}, Quaternion{n[3], n[4], n[5], n[6]}));
  } catch (const ArgumentError& error) {
    throw ArgumentError(base_.place() + ": the target pose: " + error.what());
  }
}

std::span<const double> BasePoseController::commanded_joint_pos() const {
  const std::span<const double> n = base_.target_numbers();
  joint_ = {n[0], n[1], n[2], n[6], n[3], n[4], n[5]};
  return joint_;
}

}  // namespace robocell::internal
