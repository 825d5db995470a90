#include "robocell/kinematics/normal_frames.h"

#include <cmath>

#include "robocell/kinematics/common_normal.h"

namespace robocell {
namespace {

// A cosine that is nothing but rounding.
constexpr double kPerpendicular = 1e-14;

// About and along z.
Transform Screw(double angle, double shift) {
  return {Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
          Eigen::Vector3d(0, 0, shift)};
}

// About and along x.
Transform Twist(const CommonNormal& normal) {
  const bool square = std::abs(normal.cos_twist) <= kPerpendicular;
  const double c = square ? 0 : normal.cos_twist, s = square ? 1 : normal.sin_twist;
  Transform twist;
  twist.rotation << 1, 0, 0, 0, c, -s, 0, s, c;
  twist.translation.x() = normal.length;
  return twist;
}

// What is known in a frame, in another one that stands in it like this.
LinkInertia In(const Transform& frame, const LinkInertia& link) {
  const Eigen::Matrix3d to_frame = frame.rotation.transpose();
  const Eigen::Vector3d& d = frame.translation;
  const Eigen::Vector3d& h = link.moment;
  const Eigen::Matrix3d about_origin =
      link.inertia + (link.mass * d.squaredNorm() - 2 * h.dot(d)) * Eigen::Matrix3d::Identity() +
      h * d.transpose() + d * h.transpose() - link.mass * d * d.transpose();
  LinkInertia out = link;
  out.moment = to_frame * (h - link.mass * d);
  out.weight_moment = to_frame * (link.weight_moment - link.weight_mass * d);
  out.inertia = to_frame * about_origin * frame.rotation;
  return out;
}

}  // namespace

ChainModel InNormalFrames(const ChainModel& chain) {
  ChainModel out = chain;
  std::array<double, kMaxChainJoints> angles{};  // of the new frames, from the old ones
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
      joint.fixed = Screw(0, normal->shift_before - shifts[i - 1]) * Twist(*normal);
    } else {
      joint.fixed = before.inverse() * joint.fixed;
    }
    if (joint.slide) {
      joint.fixed = joint.fixed * Screw(turn, 0);
    } else {
      joint.reference -= turn;
    }
    joint.link = In(moved, joint.link);
    joint.joint_to_body = moved.inverse() * joint.joint_to_body;
    before = moved;
  }
  out.last_to_tip = before.inverse() * chain.last_to_tip;
  return out;
}

}  // namespace robocell
