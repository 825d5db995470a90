#include "robocell/kinematics/chain_model.h"

namespace robocell {

LinkInertia InFrame(const Transform& frame, const LinkInertia& link) {
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

LinkInertia& operator+=(LinkInertia& link, const LinkInertia& more) {
  link.mass += more.mass;
  link.moment += more.moment;
  link.inertia += more.inertia;
  link.weight_mass += more.weight_mass;
  link.weight_moment += more.weight_moment;
  return link;
}

LinkInertia& operator-=(LinkInertia& link, const LinkInertia& less) {
  link.mass -= less.mass;
  link.moment -= less.moment;
  link.inertia -= less.inertia;
  link.weight_mass -= less.weight_mass;
  link.weight_moment -= less.weight_moment;
  return link;
}

}  // namespace robocell
