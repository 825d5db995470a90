#include "robocell/mujoco/coupled_positions.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "robocell/mujoco/closed_loops.h"
#include "robocell/mujoco/couplings.h"
#include "robocell/mujoco/joint_followers.h"

namespace robocell::internal {
namespace {

constexpr double kLeastShare = 0.1;  // of offsets that a loop cannot follow

bool IsScalar(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

double Clamped(double x, const JointRange& range) {
  return std::max(range.lower, std::min(x, range.upper));
}

// A joint that others follow, with these; one of a list moves them all.
struct Mechanism {
  int root = -1;
  std::ptrdiff_t driver = -1;  // index in the list; -1: the list moves the root nowhere
  JointPolynomial of_driver = {};
  std::vector<CoupledJoint> followers = {};
};

// Joints of a list by their mechanisms.
struct Mechanisms {
  std::vector<Mechanism> all;
  std::vector<CoupledJoint> held;  // joints of the list that a constraint holds in place
  std::vector<bool> stuck;         // of the list: no position of its own
};

// Marks joints that are coupled, over any number of others, with one whose couplings cannot be
// composed.
std::vector<bool> Unsolved(const mjModel* m, const ModelCouplings& found) {
  std::vector<bool> out(static_cast<std::size_t>(m->njnt));
  for (const ModelCouplings::Problem& problem : found.problems) {
    for (const int joint : problem.joints) out[joint] = true;
  }
  for (bool grows = !found.problems.empty(); grows;) {
    grows = false;
    for (int e = 0; e < m->neq; ++e) {
      const int a = m->eq_obj1id[e], b = m->eq_obj2id[e];
      if (m->eq_type[e] != mjEQ_JOINT || !m->eq_active0[e] || b < 0 || out[a] == out[b]) continue;
      out[a] = out[b] = grows = true;
    }
  }
  return out;
}

Mechanism MechanismOf(const ModelCouplings& found, int root, std::span<const int> joints) {
  Mechanism out{.root = root};
  for (const CoupledJoint& f : found.followers) {
    if (f.leader == root) out.followers.push_back(f);
  }
  const auto at = std::find(joints.begin(), joints.end(), root);
  if (at != joints.end()) {
    out.driver = at - joints.begin();
    return out;
  }
  for (std::size_t i = 0; i < joints.size() && out.driver < 0; ++i) {
    const CoupledJoint* own = joints[i] < 0 ? nullptr : found.Of(joints[i]);
    if (!own || own->leader != root) continue;
    if (!own->of_leader.affine() || own->of_leader.c[1] == 0) continue;
    out.driver = static_cast<std::ptrdiff_t>(i);
    out.of_driver = Inverse(own->of_leader);
  }
  return out;
}

Mechanisms MechanismsOf(const mjModel* m, std::span<const int> joints) {
  Mechanisms out;
  out.stuck.resize(joints.size());
  if (!AreCoupled(m, joints)) return out;
  const ModelCouplings found = FindCouplings(m);
  const std::vector<bool> unsolved = Unsolved(m, found);
  std::vector<int> roots;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] < 0) continue;
    const int root = found.LeaderOf(joints[i]);
    out.stuck[i] = unsolved[joints[i]] || root < 0;
    if (out.stuck[i]) {
      if (!unsolved[joints[i]]) out.held.push_back(*found.Of(joints[i]));
    } else if (std::find(roots.begin(), roots.end(), root) == roots.end()) {
      roots.push_back(root);
    }
  }
  for (const int root : roots) {
    Mechanism mechanism = MechanismOf(found, root, joints);
    if (!mechanism.followers.empty()) out.all.push_back(std::move(mechanism));
  }
  return out;
}

// The positions of one mechanism.
class MechanismPose {
 public:
  MechanismPose(const mjModel* m, const Mechanism& mechanism, std::span<const int> joints,
                double* qpos)
      : m_(m), mechanism_(mechanism), qpos_(qpos) {
    if (mechanism.driver >= 0) driver_ = joints[static_cast<std::size_t>(mechanism.driver)];
  }

  // Places all joints by the driver's position; by the root's if there is no driver.
  void Place() {
    if (driver_ >= 0) q(mechanism_.root) = mechanism_.of_driver.at(q(driver_));
    PlaceFollowersOfRoot(driver_);
  }

  // Places all joints by the driver's position, as far as all limits allow on the way from those
  // before. They stay where none was moved.
  void PlaceInsideLimits(const std::vector<double>& before) {
    if (!IsMoved(before)) return;
    if (driver_ < 0) return PlaceFollowersOfRoot(-1);
    const double drawn = mechanism_.of_driver.at(q(driver_));
    const double root = Allowed(before[m_->jnt_qposadr[mechanism_.root]], drawn);
    q(mechanism_.root) = root;
    PlaceFollowersOfRoot(root == drawn ? driver_ : -1);
    for (const CoupledJoint& f : mechanism_.followers) DropRounding(f.joint);
  }

 private:
  bool IsMoved(const std::vector<double>& before) const {
    const auto is_moved = [&](int joint) {
      const int at = m_->jnt_qposadr[joint];
      return qpos_[at] != before[static_cast<std::size_t>(at)];
    };
    return is_moved(mechanism_.root) ||
           std::any_of(mechanism_.followers.begin(), mechanism_.followers.end(),
                       [&](const CoupledJoint& f) { return is_moved(f.joint); });
  }

  double& q(int joint) { return qpos_[m_->jnt_qposadr[joint]]; }

  void PlaceFollowersOfRoot(int except) {
    for (const CoupledJoint& f : mechanism_.followers) {
      if (f.joint != except) q(f.joint) = f.of_leader.at(q(mechanism_.root));
    }
  }

  // Moves a joint into its range that left it by rounding only.
  void DropRounding(int joint) {
    if (IsInside(joint, q(joint))) q(joint) = Clamped(q(joint), LimitsOf(m_, joint));
  }

  bool IsInside(int joint, double x) const {
    constexpr double kRounding = 1e-12;  // rad or m, of a polynomial
    return std::abs(Clamped(x, LimitsOf(m_, joint)) - x) <= kRounding;
  }

  bool IsAllowed(double root) const {
    return std::all_of(
        mechanism_.followers.begin(), mechanism_.followers.end(),
        [&](const CoupledJoint& f) { return IsInside(f.joint, f.of_leader.at(root)); });
  }

  // Returns the position of the root next to `drawn` at which all joints are inside their limits.
  double Allowed(double before, double drawn) const {
    JointRange range = LimitsOf(m_, mechanism_.root);
    for (const CoupledJoint& f : mechanism_.followers) {
      const bool finite = std::isfinite(range.lower) && std::isfinite(range.upper);
      if (!f.of_leader.affine() && (!finite || !IsMonotone(f.of_leader, range))) continue;
      range = RangeWithin(f.of_leader, range, LimitsOf(m_, f.joint));
      if (range.lower > range.upper) return before;
    }
    const double inside = Clamped(drawn, range);
    if (IsAllowed(inside)) return inside;
    // Followers that turn back have several ranges: this is the last position on the way.
    double good = Clamped(before, range), bad = inside;
    if (!IsAllowed(good)) return before;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (good + bad);
      (IsAllowed(middle) ? good : bad) = middle;
    }
    return good;
  }

  const mjModel* m_;
  const Mechanism& mechanism_;
  double* qpos_;
  int driver_ = -1;
};

void PlaceHeld(const mjModel* m, const Mechanisms& mechanisms, double* qpos) {
  for (const CoupledJoint& joint : mechanisms.held)
    qpos[m->jnt_qposadr[joint.joint]] = joint.of_leader.at(0);
}

// Moves joints by a share of their offsets, and what follows them.
void Move(const mjModel* m, std::span<const int> joints, std::span<const double> offsets,
          double share, const std::vector<double>& before, double* qpos) {
  const Mechanisms mechanisms = MechanismsOf(m, joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] < 0 || mechanisms.stuck[i] || !IsScalar(m, joints[i])) continue;
    double& q = qpos[m->jnt_qposadr[joints[i]]];
    q = Clamped(q + share * offsets[i], LimitsOf(m, joints[i]));
  }
  for (const Mechanism& mechanism : mechanisms.all)
    MechanismPose(m, mechanism, joints, qpos).PlaceInsideLimits(before);
}

}  // namespace

void PlaceFollowers(const mjModel* m, std::span<const int> joints, double* qpos) {
  const Mechanisms mechanisms = MechanismsOf(m, joints);
  for (const Mechanism& mechanism : mechanisms.all)
    MechanismPose(m, mechanism, joints, qpos).Place();
  PlaceHeld(m, mechanisms, qpos);
}

void MoveCoupled(const mjModel* m, std::span<const int> joints, std::span<const double> offsets,
                 double* qpos) {
  const std::vector<double> before(qpos, m->neq > 0 ? qpos + m->nq : qpos);
  Move(m, joints, offsets, 1, before, qpos);
  if (std::ranges::all_of(offsets, [](double offset) { return offset == 0; })) return;
  for (double share = 0.5; !CloseLoops(m, joints, qpos); share *= 0.5) {
    std::copy(before.begin(), before.end(), qpos);
    if (share < kLeastShare) return;
    Move(m, joints, offsets, share, before, qpos);
  }
}

}  // namespace robocell::internal
