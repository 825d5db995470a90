#include "robocell/kinematics/folded_chain.h"

#include <cmath>

#include "robocell/kinematics/chain_model.h"

namespace robocell {
namespace {

// Sines of the angle between two axes. Below the first they are parallel: what is left is rounding.
// Below the second their common normal is too far away.
constexpr double kParallel = 1e-14, kNearlyParallel = 0.02;

PlainTransform Plain(const Transform& transform, double per_metre) {
  PlainTransform plain;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) plain.rotation[3 * r + c] = transform.rotation(r, c);
    plain.translation[r] = transform.translation[r] * per_metre;
  }
  return plain;
}

// A transform as: turn and shift about the old axis, along and about the normal, turn and shift
// about the new axis.
struct Link {
  bool whole = false;
  double angle_before = 0, shift_before = 0;
  double normal_length = 0, cos_twist = 1, sin_twist = 0;
  double angle_after = 0, shift_after = 0;
};

double AngleOf(const Eigen::Vector3d& direction, const Transform& frame) {
  return std::atan2(frame.rotation.col(1).dot(direction), frame.rotation.col(0).dot(direction));
}

Link LinkOf(const Transform& step) {
  Link link;
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
    link.whole = true;
    return link;
  } else {
    normal = cross / sine;
    link.cos_twist = cosine;
    link.sin_twist = sine;
    link.shift_after = (t.dot(new_axis) - cosine * t.z()) / (sine * sine);
    link.shift_before = t.z() - link.shift_after * cosine;
  }
  link.normal_length = t.dot(normal);
  link.angle_before = AngleOf(normal, {});
  link.angle_after = -AngleOf(normal, step);
  return link;
}

}  // namespace

FoldedChain Fold(const ChainModel& chain) {
  FoldedChain folded;
  folded.n = chain.n;
  folded.per_metre = 1 / chain.length;
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& joint = chain.joints[i];
    FoldedJoint& out = folded.joints[i];
    out.slide = joint.slide;
    out.lower = joint.lower;
    out.upper = joint.upper;
    (joint.slide ? out.shift : out.angle) -= joint.reference * (joint.slide ? folded.per_metre : 1);
    if (i == 0) continue;
    const Link link = LinkOf(joint.fixed);
    out.whole_link = link.whole;
    out.link = Plain(joint.fixed, folded.per_metre);
    out.normal_length = link.normal_length * folded.per_metre;
    out.cos_twist = link.cos_twist;
    out.sin_twist = link.sin_twist;
    out.angle += link.angle_after;
    out.shift += link.shift_after * folded.per_metre;
    folded.joints[i - 1].angle += link.angle_before;
    folded.joints[i - 1].shift += link.shift_before * folded.per_metre;
  }
  for (int i = 0; i < chain.n; ++i) {
    folded.joints[i].cos_angle = std::cos(folded.joints[i].angle);
    folded.joints[i].sin_angle = std::sin(folded.joints[i].angle);
  }
  folded.base = Plain(chain.joints[0].fixed, folded.per_metre);
  folded.tip = Plain(chain.last_to_tip, folded.per_metre);
  return folded;
}

}  // namespace robocell
