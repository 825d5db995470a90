#include "robocell/kinematics/link_answer.h"

#include <algorithm>

namespace robocell::internal {

ExpandedMotion::ExpandedMotion(const CoupledLinks& coupled, const LinkQuery& query)
    : has_speed_(query.qd), gravity_(query.gravity) {
  coupled.Expand(query.q, q_);
  coupled.Slopes(query.q, slopes);
  if (!has_speed_ && !query.qdd) return;
  for (int i = 0; i < coupled.links.n; ++i) {
    const int l = coupled.leader[i];
    const double speed = has_speed_ ? query.qd[l] : 0;
    // A leader at a constant speed accelerates followers whose polynomial bends.
    const double bend = coupled.polynomial[i].curvature(query.q[l]);
    qd_[i] = slopes[i] * speed;
    qdd_[i] = (query.qdd ? slopes[i] * query.qdd[l] : 0) + bend * speed * speed;
    has_change_ |= qdd_[i] != 0;
  }
}

LinkQuery ExpandedMotion::query() const {
  return {.q = q_,
          .qd = has_speed_ ? qd_ : nullptr,
          .qdd = has_change_ ? qdd_ : nullptr,
          .gravity = gravity_};
}

void ReduceRow(const CoupledLinks& coupled, const double* slopes, double* row) {
  double sums[kMaxChainJoints] = {};
  for (int i = 0; i < coupled.links.n; ++i) sums[coupled.leader[i]] += slopes[i] * row[i];
  std::copy_n(sums, coupled.n, row);
}

void ComputeCoupled(const CoupledLinks& coupled, const LinkTable& table, LinkPart part,
                    const LinkQuery& query, LinkAnswer* out) {
  const ExpandedMotion motion(coupled, query);
  const double* slopes = motion.slopes;
  const int joints = coupled.links.n;
  ComputeLinks(table, part, motion.query(), out);
  const bool all = part == LinkPart::kAll;
  if (all || part == LinkPart::kJacobian) {
    for (LinkTable::Row& row : out->jacobian) ReduceRow(coupled, slopes, row);
  }
  if (all || part == LinkPart::kMass) {
    for (int j = 0; j < joints; ++j) {
      for (int i = 0; i < j; ++i) out->mass[i][j] = out->mass[j][i];
    }
    for (const JointCoupling& c : coupled.tendons) {
      out->mass[c.first][c.second] += c.inertia;
      out->mass[c.second][c.first] += c.inertia;
    }
    for (int j = 0; j < joints; ++j) ReduceRow(coupled, slopes, out->mass[j]);
    for (int l = 0; l < coupled.n; ++l) {
      double column[kMaxChainJoints];
      for (int j = 0; j < joints; ++j) column[j] = out->mass[j][l];
      ReduceRow(coupled, slopes, column);
      for (int k = 0; k < coupled.n; ++k) out->mass[k][l] = column[k];
    }
  }
  if (all || part == LinkPart::kMotion) {
    if (const double* qdd = motion.query().qdd) {
      for (const JointCoupling& c : coupled.tendons) {
        out->torques[c.first] += c.inertia * qdd[c.second];
        out->torques[c.second] += c.inertia * qdd[c.first];
      }
    }
  }
  if (all || part == LinkPart::kMotion || part == LinkPart::kGravity)
    ReduceRow(coupled, slopes, out->torques);
}

}  // namespace robocell::internal
