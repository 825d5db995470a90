#include "robocell/robot/gripper_opening_controller.h"

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"

namespace robocell::internal {

GripperOpeningController::GripperOpeningController(GripperGroup& group)
    : group_(group), present_(group.nu()) {
  if (present_.empty()) throw ArgumentError(group.place() + " has no actuators");
  Reset();
}

void GripperOpeningController::SetTarget(std::span<const double> target) {
  RequireValues([&] { return group_.place(); }, "opening", target, 1);
  opening_ = beyond_.Clamp(target[0], {0, 1}, [&] { return group_.place() + ": opening"; });
  // Writes the control at once, so that the last command counts: the group's own SetOpening writes
  // there too.
  group_.SetOpening(opening_);
  group_.GetCtrl(present_);
  seen_ = present_[0];
}

void GripperOpeningController::Reset() {
  group_.GetCtrl(present_);
  seen_ = present_[0];
  opening_ = OpeningFor(seen_);
}

// Controls go from closed to open with the opening, usually linearly.
double GripperOpeningController::OpeningFor(double ctrl) const {
  constexpr double kSame = 1e-9;  // share of the travel from closed to open
  const double closed = group_.ctrl_for_opening(0), open = group_.ctrl_for_opening(1);
  const auto share = [&](double value) { return (value - closed) / (open - closed); };
  const double wanted = std::clamp(share(ctrl), 0.0, 1.0);
  const double got = share(group_.ctrl_for_opening(wanted));
  if (std::abs(got - wanted) <= kSame || !std::isfinite(got)) return wanted;
  double least = 0, most = 1;
  for (int i = 0; i < 40; ++i) {
    const double opening = (least + most) / 2;
    (share(group_.ctrl_for_opening(opening)) < wanted ? least : most) = opening;
  }
  return (least + most) / 2;
}

void GripperOpeningController::Compute(std::span<double> ctrl) {
  group_.GetCtrl(present_);
  if (present_[0] != seen_) Reset();
  group_.CtrlForOpening(opening_, ctrl);
  seen_ = ctrl[0];
}

}  // namespace robocell::internal
