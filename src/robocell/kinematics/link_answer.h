// Results of link_kernel.h for a chain, for other code of this library.
#pragma once

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/link_kernel.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

// The same for a chain in which joints follow others: query and result are those of its degrees of
// freedom. The mass is whole, and contains the rotors behind tendons.
void ComputeCoupled(const CoupledLinks& coupled, const LinkTable& table, LinkPart part,
                    const LinkQuery& query, LinkAnswer* out);

// Computes the part for the joints of the chain.
inline void ComputeChain(const Chain& chain, LinkPart part, const LinkQuery& query,
                         LinkAnswer* out) {
  const CoupledLinks* coupled = chain.coupled();
  if (coupled) [[unlikely]]
    return ComputeCoupled(*coupled, chain.links(), part, query, out);
  ComputeLinks(chain.links(), part, query, out);
}

// Sums what followers add to their leaders, in place: `row` has one number for each joint, and then
// one for each degree of freedom.
void ReduceRow(const CoupledLinks& coupled, const double* slopes, double* row);

// The motion of all joints, from that of the degrees of freedom.
struct ExpandedMotion {
  // Null pointers of the query stay null.
  ExpandedMotion(const CoupledLinks& coupled, const LinkQuery& query);
  LinkQuery query() const;

  double slopes[kMaxChainJoints];

 private:
  double q_[kMaxChainJoints], qd_[kMaxChainJoints], qdd_[kMaxChainJoints];
  bool has_speed_ = false, has_change_ = false;
  const double* gravity_;
};

// Returns the tip in the base frame from a result that includes it.
inline Transform TipOf(const LinkAnswer& answer) {
  Transform tip;
  for (int c = 0; c < 3; ++c)
    tip.rotation.col(c) = Eigen::Map<const Eigen::Vector3d>(answer.tip[c]);
  tip.translation = Eigen::Map<const Eigen::Vector3d>(answer.tip[3]);
  return tip;
}

}  // namespace robocell::internal
