#include "robocell/robot/move_group.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

template <class Get>
std::vector<double> Filled(int size, Get get) {
  std::vector<double> out(size);
  get(std::span<double>(out));
  return out;
}

[[noreturn]] void ThrowNotDriven(const BaseGroup& base) {
  throw ArgumentError(base.place() +
                      ": only a driven base moves to a target; give the robot `base: {kind: "
                      "driven}`, or set the base's pose, which teleports it");
}

}  // namespace

std::vector<double> MoveGroup::joint_pos() const {
  return Filled(nq(), [&](std::span<double> out) { GetJointPos(out); });
}
std::vector<double> MoveGroup::joint_vel() const {
  return Filled(nv(), [&](std::span<double> out) { GetJointVel(out); });
}
std::vector<double> MoveGroup::joint_torque() const {
  return Filled(nv(), [&](std::span<double> out) { GetJointTorque(out); });
}
std::vector<double> MoveGroup::ctrl() const {
  return Filled(nu(), [&](std::span<double> out) { GetCtrl(out); });
}
std::vector<double> MoveGroup::noop_ctrl() const {
  return Filled(nu(), [&](std::span<double> out) { NoopCtrl(out); });
}

std::vector<Interval> CheckedJointPosLimits(const MoveGroup& group) {
  std::vector<Interval> limits = group.joint_pos_limits();
  if (limits.size() != static_cast<size_t>(group.nq())) {
    throw ArgumentError(
        fmt::format("{}: joint_pos_limits has {} interval(s), expected {}, one for each "
                    "joint position (infinite where there is no limit)",
                    group.place(), limits.size(), group.nq()));
  }
  for (size_t i = 0; i < limits.size(); ++i) {
    if (limits[i].lower <= limits[i].upper) continue;
    throw ArgumentError(
        fmt::format("{}: joint_pos_limits[{}] is [{}, {}], expected [smallest, largest]",
                    group.place(), i, limits[i].lower, limits[i].upper));
  }
  return limits;
}

void GripperGroup::CtrlForOpening(double opening, std::span<double> ctrl) const {
  std::fill(ctrl.begin(), ctrl.end(), ctrl_for_opening(opening));
}

void GripperGroup::SetClosingPose(const std::string& name) {
  if (name.empty()) return;
  throw NotFoundError(fmt::format(
      "{}: no pose '{}': the gripper has no named poses. Give it some in `poses` of its group",
      place(), name));
}

void GripperGroup::MoveToPose(const std::string& name) {
  const std::vector<std::string> names = pose_names();
  if (std::ranges::find(names, name) == names.end()) {
    if (names.empty()) SetClosingPose(name);  // throws
    throw NotFoundError(NoSuchName(place(), "pose", name, names));
  }
  if (name == MoveGroupConfig::kOpenPose) return SetOpening(1);
  SetClosingPose(name);
  SetOpening(0);
}

Pose BaseGroup::target() const { ThrowNotDriven(*this); }
void BaseGroup::SetTarget(const Pose&) { ThrowNotDriven(*this); }
BaseSpeeds BaseGroup::max_speeds() const { ThrowNotDriven(*this); }
void BaseGroup::SetMaxSpeeds(const BaseSpeeds&) { ThrowNotDriven(*this); }

}  // namespace robocell
