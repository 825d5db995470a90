// The engine's values for a chain in the state of its model: the oracle of this folder's tests.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell {

// Returns the rows of a vector over all degrees of freedom that belong to the chain.
inline Eigen::VectorXd RowsOfChain(const Chain& chain, const mjtNum* all) {
  Eigen::VectorXd out(chain.n_joints());
  for (int i = 0; i < out.size(); ++i) out[i] = all[chain.joints()[i].dof_address];
  return out;
}

inline Eigen::Vector3d GravityInBase(const TestModel& t, const Chain& chain) {
  const Eigen::Vector3d gravity = Eigen::Map<const Eigen::Vector3d>(t.model()->opt.gravity);
  return t.BodyInWorld(chain.base_body()).rotation.transpose() * gravity;
}

// Makes the chain with everything attached to it at its present place.
inline Chain ChainAsItStands(const TestModel& t, const std::string& base, const ChainTip& tip) {
  const std::span<const double> qpos(t.data()->qpos, t.model()->nq);
  return Chain(t.model(), base, tip, {.qpos = qpos});
}

inline Eigen::VectorXd EngineGravityTorques(const TestModel& t, const Chain& chain) {
  mju_zero(t.data()->qvel, t.model()->nv);
  mj_forward(t.model(), t.data());
  return RowsOfChain(chain, t.data()->qfrc_bias) - RowsOfChain(chain, t.data()->qfrc_gravcomp);
}

inline Eigen::MatrixXd EngineMassMatrix(const TestModel& t, const Chain& chain) {
  const int n = chain.n_joints(), nv = t.model()->nv;
  Eigen::MatrixXd full(nv, nv), mass(n, n);
  mj_forward(t.model(), t.data());
  mj_fullM(t.model(), t.data(), full.data());
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      mass(i, j) = full(chain.joints()[i].dof_address, chain.joints()[j].dof_address);
  }
  return mass;
}

// Moves only the chain.
inline Eigen::VectorXd EngineInverseDynamics(const TestModel& t, const Chain& chain,
                                             const JointVector& qd, const JointVector& qdd) {
  mju_zero(t.data()->qvel, t.model()->nv);
  mju_zero(t.data()->qacc, t.model()->nv);
  for (int i = 0; i < chain.n_joints(); ++i) {
    t.data()->qvel[chain.joints()[i].dof_address] = qd[i];
    t.data()->qacc[chain.joints()[i].dof_address] = qdd[i];
  }
  mj_fwdPosition(t.model(), t.data());
  mj_fwdVelocity(t.model(), t.data());
  Eigen::VectorXd bias(t.model()->nv), inertial(t.model()->nv);
  mj_rne(t.model(), t.data(), 0, bias.data());
  mj_mulM(t.model(), t.data(), inertial.data(), t.data()->qacc);  // rotors included
  bias += inertial;
  return RowsOfChain(chain, bias.data()) - RowsOfChain(chain, t.data()->qfrc_gravcomp);
}

// Returns the engine's Jacobian of the tip, columns of the chain's joints, in the axes of the base
// body.
inline Eigen::MatrixXd EngineJacobian(const TestModel& t, const Chain& chain) {
  const mjModel* m = t.model();
  const Transform tip = t.TipInWorld(chain.tip());
  const int body = chain.tip().kind == ChainTip::Kind::kBody
                       ? mj_name2id(m, mjOBJ_BODY, chain.tip().name.c_str())
                       : m->site_bodyid[mj_name2id(m, mjOBJ_SITE, chain.tip().name.c_str())];
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> p(3, m->nv), r(3, m->nv);
  mj_jac(m, t.data(), p.data(), r.data(), tip.translation.data(), body);
  const Eigen::Matrix3d to_base = t.BodyInWorld(chain.base_body()).rotation.transpose();
  Eigen::MatrixXd out(6, chain.n_joints());
  for (int i = 0; i < chain.n_joints(); ++i) {
    const int dof = chain.joints()[i].dof_address;
    out.col(i) << to_base * p.col(dof), to_base * r.col(dof);
  }
  return out;
}

}  // namespace robocell
