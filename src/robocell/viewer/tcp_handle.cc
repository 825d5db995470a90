#include "robocell/viewer/tcp_handle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/joint_vector.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell::internal {
namespace {

constexpr double kNear = 0.025;  // heights of the picture

}  // namespace

TcpHandle::TcpHandle(const Robot& robot, bool commands)
    : robot_(robot), commands_(commands), length_(std::clamp(0.15 * robot.reach(), 0.03, 0.2)) {
  robot_.arm();  // throws
  Follow();
}

void TcpHandle::Follow() {
  if (!grabbed()) target_ = robot_.tcp_in_world();
}

Eigen::Vector3d TcpHandle::Tip(int axis) const {
  return target_.translation() + length_ * target_.rotation().col(axis);
}

void TcpHandle::AddMarkers(std::vector<Marker>& markers) const {
  AddFrame(markers, target_, length_);
  AddPoint(markers, target_.translation(), 0.12 * length_, {1, 0.85f, 0.2f, 0.9f});
  constexpr std::array<std::array<float, 4>, 3> kColours = {
      {{0.9f, 0.1f, 0.1f, 1}, {0.1f, 0.7f, 0.1f, 1}, {0.1f, 0.2f, 0.9f, 1}}};
  for (int axis = 0; axis < 3; ++axis) {
    AddPoint(markers, Tip(axis), (part_ == axis ? 0.14 : 0.09) * length_,
             kColours[static_cast<size_t>(axis)]);
  }
}

bool TcpHandle::Grab(const SceneView& view, const Eigen::Vector2d& place, double aspect) {
  const auto distance = [&](const Eigen::Vector3d& point) {
    const auto seen = view.Project(point);
    if (!seen) return 1e9;
    return std::hypot((seen->x() - place.x()) * aspect, seen->y() - place.y());
  };
  double best = kNear;
  part_ = kNone;
  if (const double middle = distance(target_.translation()); middle < best) {
    best = middle;
    part_ = kMiddle;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (const double tip = distance(Tip(axis)); tip < best) {
      best = tip;
      part_ = axis;
    }
  }
  return grabbed();
}

void TcpHandle::Drag(const SceneView& view, const Eigen::Vector2d& place, bool turns, double dx,
                     double dy) {
  const Pose before = target_;
  const Eigen::Vector3d at = target_.translation();
  if (turns) {
    const double angle = std::numbers::pi * (part_ == kMiddle ? dx : dx + dy);
    const Eigen::Vector3d axis = part_ == kMiddle ? Eigen::Vector3d(0, 0, 1)
                                                  : Eigen::Vector3d(target_.rotation().col(part_));
    const Pose turn = Pose::FromRotvec(Eigen::Vector3d::Zero(), angle * axis);
    target_ = Pose(at, Eigen::Matrix3d(turn.rotation() * target_.rotation()));
  } else if (part_ == kMiddle) {
    target_ = Pose(view.Unproject(place, at), Eigen::Matrix3d(target_.rotation()));
  } else {
    const Eigen::Vector3d axis = target_.rotation().col(part_);
    const Eigen::Vector3d moved = view.Unproject(place, Tip(part_)) - Tip(part_);
    target_ = Pose(at + axis.dot(moved) * axis, Eigen::Matrix3d(target_.rotation()));
  }
  MoveRobot();
  if (!problem_.empty()) target_ = before;
}

void TcpHandle::MoveRobot() {
  const Pose target = robot_.base_in_world().inverse() * target_;
  const bool drives = commands_ && robot_.ctrl_mode() == CtrlMode::kPosition;
  const std::span<const double> from = drives ? robot_.jnt_pos_cmd() : robot_.jnt_pos_msr();
  IkOptions options;
  options.seed = JointVector(from);
  const IkResult found = robot_.Ik(target, options);
  problem_ =
      found.success ? std::string() : fmt::format("robot '{}' cannot reach there", robot_.name());
  if (!found.success) return;
  if (drives) {
    robot_.SetJntPosCmd(found.q);
  } else {
    robot_.SetJointPos(found.q);
  }
}

}  // namespace robocell::internal
