#include "robocell/mujoco/closed_loops.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <Eigen/Dense>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kLoopClosed =
    1e-5;  // m or rad that count as closed: soft constraints creep by more
constexpr double kLoopSolved = 1e-10;  // m or rad at which the search ends
constexpr double kMostLoopStep = 0.3;  // rad or m
constexpr int kLoopIterations = 100;

bool IsOneDof(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

// Adds the joints from a body up to, and without, one that carries it.
void AddJointsOfBranch(const mjModel* m, int body, int top, std::vector<int>* joints) {
  for (; body != top; body = m->body_parentid[body]) {
    for (int k = 0; k < m->body_jntnum[body]; ++k) joints->push_back(m->body_jntadr[body] + k);
  }
}

std::vector<int> JointsAlongTendon(const mjModel* m, int tendon) {
  std::vector<int> joints;
  for (int w = m->tendon_adr[tendon]; w < m->tendon_adr[tendon] + m->tendon_num[tendon]; ++w) {
    if (m->wrap_type[w] == mjWRAP_JOINT) joints.push_back(m->wrap_objid[w]);
  }
  return joints;
}

std::vector<int> JointsTiedBy(const mjModel* m, int equality) {
  const int a = m->eq_obj1id[equality], b = m->eq_obj2id[equality];
  std::vector<int> joints;
  if (m->eq_type[equality] == mjEQ_TENDON) {
    joints = JointsAlongTendon(m, a);
    if (b >= 0) {
      const std::vector<int> others = JointsAlongTendon(m, b);
      joints.insert(joints.end(), others.begin(), others.end());
    }
  } else if (m->eq_type[equality] == mjEQ_CONNECT || m->eq_type[equality] == mjEQ_WELD) {
    const auto kind = static_cast<mjtObj>(m->eq_objtype[equality]);
    const int first = BodyOf(m, kind, a), second = BodyOf(m, kind, b);
    const int top = CommonAncestor(m, first, second);
    AddJointsOfBranch(m, first, top, &joints);
    AddJointsOfBranch(m, second, top, &joints);
  }
  return joints;
}

bool HaveCommon(const std::vector<int>& a, std::span<const int> b) {
  return std::ranges::any_of(a, [&](int joint) { return std::ranges::find(b, joint) != b.end(); });
}

// Solves for the positions of some joints.
class LoopSolver {
 public:
  LoopSolver(const mjModel* m, std::vector<bool> equalities, std::vector<int> joints)
      : m_(m), equalities_(std::move(equalities)), joints_(std::move(joints)), d_(MakeData(m)) {}

  bool Run(double* qpos) {
    std::copy_n(qpos, m_->nq, d_->qpos);
    double error = Measure();
    if (error <= kLoopClosed) return true;
    double damping = 1e-6;
    for (int i = 0; i < kLoopIterations && error > kLoopSolved; ++i) {
      const std::vector<double> before(d_->qpos, d_->qpos + m_->nq);
      const double square = residual_.squaredNorm();
      Step(damping);
      error = Measure();
      if (residual_.squaredNorm() < square) {
        damping = std::max(damping / 10, 1e-12);
        continue;
      }
      std::copy(before.begin(), before.end(), d_->qpos);
      error = Measure();
      if (damping > 1e6) break;
      damping *= 10;
    }
    if (error > kLoopClosed) return false;
    std::copy_n(d_->qpos, m_->nq, qpos);
    return true;
  }

 private:
  // Fills residual and Jacobian; returns the largest error.
  double Measure() {
    mjData* d = d_.get();
    Guarded("closing a loop", d, [&] {
      mj_kinematics(m_, d);
      mj_comPos(m_, d);
      mj_tendon(m_, d);
      mj_makeConstraint(m_, d);
    });
    std::vector<int> rows;
    for (int r = 0; r < d_->nefc; ++r) {
      if (d_->efc_type[r] == mjCNSTR_EQUALITY && equalities_[d_->efc_id[r]]) rows.push_back(r);
    }
    residual_.resize(std::ssize(rows));
    jacobian_.resize(std::ssize(rows), std::ssize(joints_));
    for (std::ptrdiff_t i = 0; i < std::ssize(rows); ++i) residual_[i] = d_->efc_pos[rows[i]];
    std::vector<double> unit(m_->nv), column(d_->nefc);
    for (std::ptrdiff_t k = 0; k < std::ssize(joints_); ++k) {
      double& dof = unit[m_->jnt_dofadr[joints_[k]]];
      dof = 1;
      mj_mulJacVec(m_, d_.get(), column.data(), unit.data());
      dof = 0;
      for (std::ptrdiff_t i = 0; i < std::ssize(rows); ++i) jacobian_(i, k) = column[rows[i]];
    }
    return residual_.size() ? residual_.cwiseAbs().maxCoeff() : 0;
  }

  void Step(double damping) {
    Eigen::MatrixXd normal = jacobian_.transpose() * jacobian_;
    normal.diagonal().array() += damping;
    Eigen::VectorXd step = -normal.ldlt().solve(jacobian_.transpose() * residual_);
    const double most = step.cwiseAbs().maxCoeff();
    if (most > kMostLoopStep) step *= kMostLoopStep / most;
    for (std::ptrdiff_t k = 0; k < std::ssize(joints_); ++k) {
      double& q = d_->qpos[m_->jnt_qposadr[joints_[k]]];
      const JointRange range = LimitsOf(m_, joints_[k]);
      q = std::clamp(q + step[k], range.lower, range.upper);
    }
  }

  const mjModel* m_;
  std::vector<bool> equalities_;
  std::vector<int> joints_;
  DataPtr d_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd jacobian_;
};

std::string QuotedName(const mjModel* m, mjtObj kind, int id) {
  const std::string name = ElementName(m, kind, id);
  return name.empty() ? fmt::format("#{}", id) : fmt::format("'{}'", name);
}

}  // namespace

std::vector<ClosedLoop> FindClosedLoops(const mjModel* m) {
  std::vector<ClosedLoop> loops;
  if ((m->opt.disableflags & (mjDSBL_EQUALITY | mjDSBL_CONSTRAINT)) != 0) return loops;
  for (int e = 0; e < m->neq; ++e) {
    if (!m->eq_active0[e]) continue;
    std::vector<int> joints = JointsTiedBy(m, e);
    if (joints.empty() || !std::ranges::all_of(joints, [&](int j) { return IsOneDof(m, j); }))
      continue;
    std::ranges::sort(joints);
    joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
    loops.push_back({e, std::move(joints)});
  }
  return loops;
}

bool CloseLoops(const mjModel* m, std::span<const int> joints, double* qpos) {
  std::vector<ClosedLoop> ties = FindClosedLoops(m);
  if (ties.empty()) return true;
  const auto loops = std::ssize(ties);
  for (int e = 0; e < m->neq; ++e) {  // joints that follow one of these keep doing so
    if (m->eq_type[e] != mjEQ_JOINT || !m->eq_active0[e]) continue;
    ties.push_back({e, {m->eq_obj1id[e]}});
    if (m->eq_obj2id[e] >= 0) ties.back().joints.push_back(m->eq_obj2id[e]);
  }
  std::vector<bool> equalities(static_cast<std::size_t>(m->neq));
  std::vector<int> tied(joints.begin(), joints.end());
  std::vector<int> free;
  for (bool grows = true; grows;) {
    grows = false;
    for (const ClosedLoop& tie : ties) {
      if (equalities[tie.equality] || !HaveCommon(tie.joints, tied)) continue;
      equalities[tie.equality] = grows = true;
      for (const int joint : tie.joints) {
        if (std::ranges::find(tied, joint) != tied.end()) continue;
        tied.push_back(joint);
        free.push_back(joint);
      }
    }
  }
  const bool has_loop =
      std::any_of(ties.begin(), ties.begin() + loops,
                  [&](const ClosedLoop& loop) { return equalities[loop.equality]; });
  if (!has_loop || free.empty()) return true;
  return LoopSolver(m, std::move(equalities), std::move(free)).Run(qpos);
}

std::string DescribeLoopOf(const mjModel* m, int joint) {
  for (const ClosedLoop& loop : FindClosedLoops(m)) {
    if (std::ranges::find(loop.joints, joint) == loop.joints.end()) continue;
    const int e = loop.equality, a = m->eq_obj1id[e], b = m->eq_obj2id[e];
    const std::string name = QuotedName(m, mjOBJ_EQUALITY, e);
    if (m->eq_type[e] == mjEQ_TENDON) {
      return fmt::format(
          "one of the joints that equality {} of tendon {} holds together", name,
          b < 0 ? QuotedName(m, mjOBJ_TENDON, a)
                : QuotedName(m, mjOBJ_TENDON, a) + " and " + QuotedName(m, mjOBJ_TENDON, b));
    }
    const auto kind = static_cast<mjtObj>(m->eq_objtype[e]);
    return fmt::format("part of the loop that {} closes, a {} of {} and {}", name,
                       m->eq_type[e] == mjEQ_WELD ? "weld" : "connect", QuotedName(m, kind, a),
                       QuotedName(m, kind, b));
  }
  return "";
}

}  // namespace robocell::internal
