#include "robocell/kinematics/chain_reduction.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/mujoco/couplings.h"
#include "robocell/mujoco/joint_followers.h"

namespace robocell::internal {
namespace {

class Reducer {
 public:
  Reducer(const mjModel* m, const std::string& place, BuiltChain* chain)
      : place_(place), chain_(*chain), found_(FindCouplings(m)) {}

  void Run() {
    const int n = chain_.model.n;
    for (int i = 0; i < n; ++i) {
      const ModelCouplings::Problem* problem = found_.ProblemOf(chain_.joints[i].id);
      if (problem) Refuse(problem->why);
    }
    for (int i = 0; i < n; ++i) FindLeader(i);
    const bool any = std::any_of(leader_.begin(), leader_.begin() + n,
                                 [&, i = 0](int leader) mutable { return leader != i++; });
    if (!any) return;
    for (int i = 0; i < n; ++i) NarrowLimits(i);
    Reduce();
  }

 private:
  [[noreturn]] void Refuse(std::string_view why) const {
    throw ArgumentError(fmt::format("{}: {}", place_, why));
  }

  int IndexOf(int joint) const {
    for (int i = 0; i < chain_.model.n; ++i) {
      if (chain_.joints[i].id == joint) return i;
    }
    return -1;
  }

  void FindLeader(int i) {
    leader_[i] = i;
    const CoupledJoint* follower = found_.Of(chain_.joints[i].id);
    if (!follower) return;
    polynomial_[i] = follower->of_leader;
    leader_[i] = follower->leader < 0 ? -1 : IndexOf(follower->leader);
    if (follower->leader < 0 || leader_[i] >= 0) return;
    // The leader is outside: the first joint of the chain that follows it leads the others.
    for (int k = 0; k <= i; ++k) {
      const CoupledJoint* first = found_.Of(chain_.joints[k].id);
      if (!first || first->leader != follower->leader) continue;
      leader_[i] = k;
      if (k == i) {
        polynomial_[i] = {};
        return;
      }
      if (!first->of_leader.affine() || first->of_leader.c[1] == 0) {
        Refuse(fmt::format(
            "joints '{}' and '{}' follow a joint that is not between base and tip, and the first "
            "of them by a polynomial that bends. Let one of them follow the other",
            chain_.joints[k].name, chain_.joints[i].name));
      }
      polynomial_[i] = Compose(follower->of_leader, Inverse(first->of_leader));
      return;
    }
  }

  // Limits a leader to values at which its follower i is within its own limits.
  void NarrowLimits(int i) {
    const int l = leader_[i];
    if (l < 0 || l == i) return;
    const ChainJoint& follower = chain_.joints[i];
    ChainJoint& leader = chain_.joints[l];
    const JointPolynomial& p = polynomial_[i];
    JointRange x{leader.lower, leader.upper};
    if (!p.affine()) {
      if (!std::isfinite(x.lower) || !std::isfinite(x.upper)) {
        Refuse(fmt::format(
            "joint '{}' follows '{}' by a polynomial that bends, and '{}' has no limits. Give it "
            "a range",
            follower.name, leader.name, leader.name));
      }
      if (!IsMonotone(p, x)) {
        Refuse(fmt::format(
            "joint '{}' follows '{}' by a polynomial that turns back within the limits of '{}', "
            "{:.4g} to {:.4g}. Narrow them, or change the polynomial",
            follower.name, leader.name, leader.name, x.lower, x.upper));
      }
    }
    if (!follower.limited) return;
    const JointRange within = RangeWithin(p, x, {follower.lower, follower.upper});
    if (within.lower > within.upper) {
      const JointRange image = ImageOf(p, x);
      Refuse(fmt::format(
          "joint '{}' follows '{}' outside of its own limits, {:.4g} to {:.4g}: it would be "
          "{:.4g} to {:.4g}. Correct a range or the coupling",
          follower.name, leader.name, follower.lower, follower.upper, image.lower, image.upper));
    }
    leader.limited = std::isfinite(within.lower) && std::isfinite(within.upper);
    leader.lower = within.lower;
    leader.upper = within.upper;
  }

  void Reduce() {
    auto coupled = std::make_shared<CoupledLinks>();
    std::vector<ChainJoint> joints;
    std::array<int, kMaxChainJoints> dof_of{};
    const int n = chain_.model.n;
    for (int i = 0; i < n; ++i) {
      if (leader_[i] != i) continue;
      dof_of[i] = coupled->n;
      coupled->joint_of[coupled->n++] = i;
      joints.push_back(chain_.joints[i]);
    }
    if (joints.empty())
      Refuse("equality constraints hold all joints between base and tip, so nothing moves");
    coupled->links = chain_.model;
    coupled->tendons = std::move(chain_.couplings);
    ChainModel& reduced = chain_.model;
    reduced.n = coupled->n;
    for (int l = 0; l < coupled->n; ++l) {
      const int i = coupled->joint_of[l];
      reduced.joints[l] = coupled->links.joints[i];
      reduced.joints[l].lower = joints[l].lower;
      reduced.joints[l].upper = joints[l].upper;
    }
    reduced.joints[0].fixed = coupled->links.joints[0].fixed;
    for (int i = 0; i < n; ++i) {
      const bool held = leader_[i] < 0;
      const int l = held ? 0 : dof_of[leader_[i]];
      coupled->leader[i] = l;
      coupled->polynomial[i] = polynomial_[i];
      JointModel& link = coupled->links.joints[i];
      const JointRange range = ImageOf(polynomial_[i], {joints[l].lower, joints[l].upper});
      link.lower = range.lower;
      link.upper = range.upper;
      if (leader_[i] != i)
        chain_.followers.push_back({chain_.joints[i], held ? -1 : l, polynomial_[i]});
    }
    MeasureLength(&coupled->links);
    reduced.reach_bound = coupled->links.reach_bound;
    reduced.length = coupled->links.length;
    chain_.couplings.clear();
    chain_.link_joints = std::exchange(chain_.joints, std::move(joints));
    reduced.coupled = std::move(coupled);
  }

  const std::string& place_;
  BuiltChain& chain_;
  ModelCouplings found_;
  std::array<int, kMaxChainJoints> leader_{};  // index of a joint of the chain; -1: held in place
  std::array<JointPolynomial, kMaxChainJoints> polynomial_{};
};

}  // namespace

void ReduceChain(const mjModel* m, const std::string& place, BuiltChain* chain) {
  if (m->neq > 0) Reducer(m, place, chain).Run();
}

}  // namespace robocell::internal
