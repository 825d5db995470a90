#include "robocell/kinematics/normal_frames.h"

#include <cmath>

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {
namespace {

// A cosine below this is only rounding.
constexpr double kPerpendicular = 1e-14;
// The same for a length, as a share of the chain's.
constexpr double kNoLength = 1e-15;

// Returns a screw motion about and along z.
Transform Screw(double angle, double shift) {
  return {Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
          Eigen::Vector3d(0, 0, shift)};
}

// Returns the length, or 0 if it is only rounding.
double Length(double length, const ChainModel& chain) {
  return std::abs(length) <= kNoLength * chain.length ? 0 : length;
}

// Returns a screw motion about and along x.
Transform TwistOnNormal(const CommonNormal& normal, const ChainModel& chain) {
  const bool square = std::abs(normal.cos_twist) <= kPerpendicular;
  const double c = square ? 0 : normal.cos_twist, s = square ? 1 : normal.sin_twist;
  Transform twist;
  twist.rotation << 1, 0, 0, 0, c, -s, 0, s, c;
  twist.translation.x() = Length(normal.length, chain);
  return twist;
}

}  // namespace

ChainModel InNormalFrames(const ChainModel& chain) {
  ChainModel out = chain;
  std::array<double, kMaxChainJoints> angles{};  // angles from the old frames to the new ones
  std::array<double, kMaxChainJoints> shifts{};
  for (int i = 1; i < chain.n; ++i) {
    const auto normal = CommonNormalOf(chain.joints[i].fixed);
    if (!normal) continue;
    angles[i - 1] = normal->angle_before;
    shifts[i] = -normal->shift_after;
  }
  Transform before;  // the new frame in the old one
  for (int i = 0; i < chain.n; ++i) {
    const Transform moved = Screw(angles[i], shifts[i]);
    JointModel& joint = out.joints[i];
    double turn = angles[i];
    const auto normal = i > 0 ? CommonNormalOf(joint.fixed) : std::nullopt;
    if (normal) {
      turn += normal->angle_after;
      const double shift = Length(normal->shift_before - shifts[i - 1], chain);
      joint.fixed = Screw(0, shift) * TwistOnNormal(*normal, chain);
    } else {
      joint.fixed = before.inverse() * joint.fixed;
    }
    if (joint.slide) {
      joint.fixed = joint.fixed * Screw(turn, 0);
    } else {
      joint.reference -= turn;
    }
    joint.link = InFrame(moved, joint.link);
    joint.joint_to_body = moved.inverse() * joint.joint_to_body;
    before = moved;
  }
  out.last_to_tip = before.inverse() * chain.last_to_tip;
  return out;
}

namespace {

// Sines of the angle between two axes. Below the first they are parallel: the rest is rounding.
// Below the second their common normal is too far away.
constexpr double kParallel = 1e-14, kNearlyParallel = 0.02;

double AngleOf(const Eigen::Vector3d& direction, const Transform& frame) {
  return std::atan2(frame.rotation.col(1).dot(direction), frame.rotation.col(0).dot(direction));
}

}  // namespace

std::optional<CommonNormal> CommonNormalOf(const Transform& step) {
  CommonNormal link;
  const Eigen::Vector3d old_axis = Eigen::Vector3d::UnitZ(), new_axis = step.rotation.col(2);
  const Eigen::Vector3d cross = old_axis.cross(new_axis);
  const double sine = cross.norm(), cosine = new_axis.z();
  const Eigen::Vector3d& t = step.translation;
  Eigen::Vector3d normal;
  if (sine <= kParallel) {
    normal = Eigen::Vector3d(t.x(), t.y(), 0);
    normal = normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::UnitX();
    link.cos_twist = std::copysign(1, cosine);
    link.shift_before = t.z();
  } else if (sine < kNearlyParallel) {
    return std::nullopt;
  } else {
    normal = cross / sine;
    link.cos_twist = cosine;
    link.sin_twist = sine;
    link.shift_after = (t.dot(new_axis) - cosine * t.z()) / (sine * sine);
    link.shift_before = t.z() - link.shift_after * cosine;
  }
  link.length = t.dot(normal);
  link.angle_before = AngleOf(normal, {});
  link.angle_after = -AngleOf(normal, step);
  return link;
}

}  // namespace robocell::internal
