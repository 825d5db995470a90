#include "robocell/robot/gripper_opening_controller.h"

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"

namespace robocell::internal {

GripperOpeningController::GripperOpeningController(GripperGroup& group)
    : group_(group),
      seen_(group.nu()),
      present_(group.nu()),
      open_(group.nu()),
      closed_(group.nu()),
      tried_(group.nu()) {
  if (present_.empty()) throw ArgumentError(group.place() + " has no actuators");
  Reset();
}

void GripperOpeningController::SetTarget(std::span<const double> target) {
  RequireValues([&] { return group_.place(); }, "opening", target, 1);
  opening_ = beyond_.Clamp(target[0], {0, 1}, [&] { return group_.place() + ": opening"; });
  // Writes the control at once, so that the last command counts: the group's own SetOpening writes
  // there too.
  group_.SetOpening(opening_);
  group_.GetCtrl(seen_);
}

void GripperOpeningController::Reset() {
  group_.GetCtrl(seen_);
  opening_ = OpeningFor(seen_);
}

// Controls go from closed to open with the opening, usually linearly. Of several actuators the one
// that travels farthest counts, because in some poses of a hand others stay where they are.
double GripperOpeningController::OpeningFor(std::span<const double> ctrl) {
  constexpr double kSame = 1e-9;  // share of the travel from closed to open
  group_.CtrlForOpening(0, closed_);
  group_.CtrlForOpening(1, open_);
  size_t farthest = 0;
  for (size_t i = 1; i < open_.size(); ++i) {
    if (std::abs(open_[i] - closed_[i]) > std::abs(open_[farthest] - closed_[farthest]))
      farthest = i;
  }
  const double closed = closed_[farthest], travel = open_[farthest] - closed;
  if (travel == 0) return opening_;
  const auto share_at = [&](double opening) {
    group_.CtrlForOpening(opening, tried_);
    return (tried_[farthest] - closed) / travel;
  };
  const double wanted = std::clamp((ctrl[farthest] - closed) / travel, 0.0, 1.0);
  const double got = share_at(wanted);
  if (std::abs(got - wanted) <= kSame || !std::isfinite(got)) return wanted;
  double least = 0, most = 1;
  for (int i = 0; i < 40; ++i) {
    const double opening = (least + most) / 2;
    (share_at(opening) < wanted ? least : most) = opening;
  }
  return (least + most) / 2;
}

void GripperOpeningController::Compute(std::span<double> ctrl) {
  group_.GetCtrl(present_);
  if (present_ != seen_) Reset();
  group_.CtrlForOpening(opening_, ctrl);
  std::ranges::copy(ctrl, seen_.begin());
}

}  // namespace robocell::internal
