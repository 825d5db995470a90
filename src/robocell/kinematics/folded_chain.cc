#include "robocell/kinematics/folded_chain.h"

#include <cmath>
#include <numbers>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/normal_frames.h"

namespace robocell::internal {
namespace {

PlainTransform Plain(const Transform& transform, double per_metre) {
  PlainTransform plain;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) plain.rotation[3 * r + c] = transform.rotation(r, c);
    plain.translation[r] = transform.translation[r] * per_metre;
  }
  return plain;
}

}  // namespace

FoldedChain Fold(const ChainModel& chain) {
  FoldedChain folded;
  folded.n = chain.n;
  folded.length = chain.length;
  folded.per_metre = 1 / chain.length;
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& joint = chain.joints[i];
    FoldedJoint& out = folded.joints[i];
    out.slide = joint.slide;
    out.lower = joint.lower;
    out.upper = joint.upper;
    out.has_whole_turn = !joint.slide && joint.upper - joint.lower >= 2 * std::numbers::pi;
    folded.has_whole_turns |= out.has_whole_turn;
    (joint.slide ? out.shift : out.angle) -= joint.reference * (joint.slide ? folded.per_metre : 1);
    if (i == 0) continue;
    const std::optional<CommonNormal> normal = CommonNormalOf(joint.fixed);
    const CommonNormal link = normal.value_or(CommonNormal{});
    out.whole_link = !normal;
    out.link = Plain(joint.fixed, folded.per_metre);
    out.normal_length = link.length * folded.per_metre;
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

CoupledFold FoldCoupled(const ChainModel& chain) {
  const CoupledLinks& coupled = *chain.coupled;
  CoupledFold out{.chain = Fold(coupled.links), .coupling = {}};
  FoldedCoupling& coupling = out.coupling;
  coupling.links = out.chain;
  out.chain.n = coupled.n;
  out.chain.has_whole_turns = false;
  for (int l = 0; l < coupled.n; ++l) {
    FoldedJoint& dof = out.chain.joints[l];
    dof = {};
    dof.slide = chain.joints[l].slide;
    dof.lower = chain.joints[l].lower;
    dof.upper = chain.joints[l].upper;
    for (int i = 0; i < coupled.links.n; ++i)
      dof.leads |= coupled.leader[i] == l && coupled.joint_of[l] != i;
    dof.has_whole_turn = !dof.slide && !dof.leads && dof.upper - dof.lower >= 2 * std::numbers::pi;
    out.chain.has_whole_turns |= dof.has_whole_turn;
  }
  for (int i = 0; i < coupled.links.n; ++i) {
    const int l = coupled.leader[i];
    coupling.leader[i] = l;
    coupling.from[i] = coupled.polynomial[i].from;
    for (std::size_t p = 0; p < 5; ++p) coupling.polynomial[i][p] = coupled.polynomial[i].c[p];
    coupling.unit[i] = UnitOf(chain, l) / UnitOf(coupled.links, i);
  }
  return out;
}

}  // namespace robocell::internal
