#include "robocell/robot/gripper_opening_controller.h"

#include <algorithm>

#include "robocell/base/error.h"

namespace robocell {

GripperOpeningController::GripperOpeningController(GripperGroup& group)
    : group_(group), present_(group.nu()) {
  if (present_.empty()) throw ArgumentError(group.place() + " has no actuators");
  Reset();
}

void GripperOpeningController::SetTarget(std::span<const double> target) {
  CheckValues([&] { return group_.place(); }, "opening", target, 1);
  opening_ = beyond_.Clamp(target[0], {0, 1}, [&] { return group_.place() + ": opening"; });
  // At once, so that whoever commands last is obeyed: the group's own SetOpening writes there too.
  group_.SetOpening(opening_);
  group_.GetCtrl(present_);
  seen_ = present_[0];
}

void GripperOpeningController::Reset() {
  group_.GetCtrl(present_);
  seen_ = present_[0];
  const double closed = group_.ctrl_for_opening(0), open = group_.ctrl_for_opening(1);
  opening_ = std::clamp((seen_ - closed) / (open - closed), 0.0, 1.0);
}

void GripperOpeningController::Compute(std::span<double> ctrl) {
  group_.GetCtrl(present_);
  if (present_[0] != seen_) Reset();
  group_.CtrlForOpening(opening_, ctrl);
  seen_ = ctrl[0];
}

}  // namespace robocell
