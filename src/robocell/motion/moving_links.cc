#include "robocell/motion/moving_links.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Transform PoseOfBody(const mjData* d, int body) {
  return {Eigen::Map<const RowMajor>(d->xmat + 9 * body),
          Eigen::Map<const Eigen::Vector3d>(d->xpos + 3 * body)};
}

// Returns a frame whose z axis is the joint's.
Transform FrameOfJoint(const mjData* d, int joint) {
  const Eigen::Map<const Eigen::Vector3d> axis(d->xaxis + 3 * joint);
  const Eigen::Map<const Eigen::Vector3d> anchor(d->xanchor + 3 * joint);
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();
  if (std::abs(axis.x()) > 0.8) across = Eigen::Vector3d::UnitY();
  Transform frame{.translation = anchor};
  frame.rotation.col(2) = axis.normalized();
  frame.rotation.col(0) = (across - axis * axis.dot(across)).normalized();
  frame.rotation.col(1) = frame.rotation.col(2).cross(frame.rotation.col(0));
  return frame;
}

}  // namespace

MovingLinks::MovingLinks(const mjModel* m, const mjData* d, std::span<const int> joints,
                         std::string_view place) {
  struct Moved {
    int dof = -1;
    JointPolynomial of_dof;
  };
  std::vector<Moved> moved(m->njnt);
  for (const int joint : joints) {
    const auto name = [&] { return Describe(m, mjOBJ_JOINT, joint); };
    const int type = m->jnt_type[joint];
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) {
      throw ArgumentError(fmt::format(
          "{}: {} is a ball or free joint; motions are planned for hinges and slides only", place,
          name()));
    }
    if (moved[joint].dof >= 0)
      throw ArgumentError(fmt::format("{}: {} appears twice", place, name()));
    moved[joint].dof = n_dofs();
    const JointRange range = LimitsOf(m, joint);
    dofs_.push_back({joint, type == mjJNT_SLIDE, std::isfinite(range.upper - range.lower),
                     range.lower, range.upper});
  }
  for (const ListedFollower& follower : FollowersAmong(m, joints)) {
    throw ArgumentError(fmt::format("{}: {} follows {}; plan with the latter alone", place,
                                    Describe(m, mjOBJ_JOINT, joints[follower.index]),
                                    Describe(m, mjOBJ_JOINT, joints[follower.leader])));
  }
  for (const JointFollower& follower : FollowersOf(m, joints)) {
    const int dof = static_cast<int>(follower.leader);
    moved[follower.joint] = {dof, follower.of_leader};
    const JointRange own = LimitsOf(m, follower.joint);
    JointRange range{dofs_[dof].lower, dofs_[dof].upper};
    if (!IsMonotone(follower.of_leader, range)) continue;
    range = RangeWithin(follower.of_leader, range, own);
    dofs_[dof].lower = range.lower;
    dofs_[dof].upper = range.upper;
    dofs_[dof].limited = std::isfinite(range.upper - range.lower);
  }

  links_.push_back({});
  at_present_.push_back({});
  link_of_.assign(m->nbody, 0);
  in_link_.resize(m->nbody);
  for (int body = 0; body < m->nbody; ++body) {
    int link = body == 0 ? 0 : link_of_[m->body_parentid[body]];
    const int first = m->body_jntadr[body];
    for (int joint = first; joint < first + m->body_jntnum[body]; ++joint) {
      const Moved& how = moved[joint];
      if (how.dof < 0) continue;
      const Transform frame = FrameOfJoint(d, joint);
      links_.push_back({link, at_present_[link].inverse() * frame,
                        m->jnt_type[joint] == mjJNT_SLIDE, how.dof, d->qpos[m->jnt_qposadr[joint]],
                        how.of_dof});
      at_present_.push_back(frame);
      link = static_cast<int>(links_.size()) - 1;
    }
    link_of_[body] = link;
    in_link_[body] = at_present_[link].inverse() * PoseOfBody(d, body);
  }
}

void MovingLinks::Attach(const mjModel* m, const mjData* d, int body, int link) {
  for (int b = 0; b < m->nbody; ++b) {
    if (!IsInSubtree(m, b, body)) continue;
    link_of_[b] = link;
    in_link_[b] = at_present_[link].inverse() * PoseOfBody(d, b);
  }
}

void MovingLinks::Place(std::span<const double> q, std::span<Transform> poses) const {
  poses[0] = {};
  for (size_t i = 1; i < links_.size(); ++i) {
    const Link& link = links_[i];
    Transform pose = poses[link.parent] * link.fixed;
    const double by = link.of_dof.at(q[link.dof]) - link.reference;
    if (link.slide) {
      pose.translation += pose.rotation.col(2) * by;
    } else {
      const double c = std::cos(by), s = std::sin(by);
      const Eigen::Vector3d x = pose.rotation.col(0), y = pose.rotation.col(1);
      pose.rotation.col(0) = c * x + s * y;
      pose.rotation.col(1) = c * y - s * x;
    }
    poses[i] = pose;
  }
}

}  // namespace robocell::internal
