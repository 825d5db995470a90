// Kinematics and dynamics of Chain (chain.h): checks arguments and calls the kernel.
#include <algorithm>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/link_answer.h"

namespace robocell {

namespace {

void CopyTorques(const internal::LinkAnswer& answer, std::span<double> out) {
  std::copy_n(answer.torques, out.size(), out.begin());
}

}  // namespace

Pose Chain::Fk(std::span<const double> q) const {
  RequireJointValues("q", q);
  internal::LinkAnswer answer;
  internal::ComputeChain(*this, internal::LinkPart::kTip, {.q = q.data()}, &answer);
  return internal::TipOf(answer).pose();
}

Pose Chain::FkAll(std::span<const double> q, std::span<Pose> bodies) const {
  RequireSize("bodies", bodies.size());
  const Pose tip = Fk(q);
  const ChainModel& links = LinksOf(model());
  int next = 0;  // degree of freedom
  WalkChain(model(), q.data(), [&](int i, const Transform& frame) {
    if (coupled_ && (next == coupled_->n || coupled_->joint_of[next] != i)) return;
    bodies[next++] = (frame * links.joints[i].joint_to_body).pose();
  });
  return tip;
}

Pose Chain::Jacobian(std::span<const double> q,
                     Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const {
  RequireJointValues("q", q);
  RequireSize("columns of the Jacobian", out.cols());
  internal::LinkAnswer answer;
  internal::ComputeChain(*this, internal::LinkPart::kJacobian, {.q = q.data()}, &answer);
  for (int i = 0; i < n_joints(); ++i) {
    for (int r = 0; r < 6; ++r) out(r, i) = answer.jacobian[r][i];
  }
  return internal::TipOf(answer).pose();
}

void Chain::GravityTorques(std::span<const double> q, const Eigen::Vector3d& gravity,
                           std::span<double> out) const {
  RequireSize("q", q.size());
  RequireSize("torques", out.size());
  internal::LinkAnswer answer;
  internal::ComputeChain(*this, internal::LinkPart::kGravity,
                         {.q = q.data(), .gravity = gravity.data()}, &answer);
  CopyTorques(answer, out);
}

void Chain::MassMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> out) const {
  RequireSize("q", q.size());
  RequireSize("rows of the mass matrix", out.rows());
  RequireSize("columns of the mass matrix", out.cols());
  internal::LinkAnswer answer;
  internal::ComputeChain(*this, internal::LinkPart::kMass, {.q = q.data()}, &answer);
  for (int j = 0; j < n_joints(); ++j) {
    for (int i = 0; i < n_joints(); ++i) out(i, j) = answer.mass[j][i];
  }
  for (const JointCoupling& c : couplings()) {
    out(c.first, c.second) += c.inertia;
    out(c.second, c.first) += c.inertia;
  }
}

void Chain::CoriolisTorques(std::span<const double> q, std::span<const double> qd,
                            std::span<double> out) const {
  const JointVector still(n_joints());
  InverseDynamics(q, qd, still, Eigen::Vector3d::Zero(), out);
}

void Chain::InverseDynamics(std::span<const double> q, std::span<const double> qd,
                            std::span<const double> qdd, const Eigen::Vector3d& gravity_in_base,
                            std::span<double> out) const {
  RequireSize("q", q.size());
  RequireSize("qd", qd.size());
  RequireSize("qdd", qdd.size());
  RequireSize("torques", out.size());
  internal::LinkAnswer answer;
  const internal::LinkQuery query{
      .q = q.data(), .qd = qd.data(), .qdd = qdd.data(), .gravity = gravity_in_base.data()};
  internal::ComputeChain(*this, internal::LinkPart::kMotion, query, &answer);
  CopyTorques(answer, out);
  for (const JointCoupling& c : couplings()) {
    out[c.first] += c.inertia * qdd[c.second];
    out[c.second] += c.inertia * qdd[c.first];
  }
}

}  // namespace robocell
