#include "robocell/kinematics/base_inertial_parameters.h"

#include "robocell/kinematics/chain_model.h"

namespace robocell::internal {
namespace {

// Returns the part of a link's inertia that is symmetric about its frame's z axis.
LinkInertia RoundPart(const LinkInertia& link) {
  LinkInertia round;
  round.mass = link.mass;
  round.weight_mass = link.weight_mass;
  round.moment.z() = link.moment.z();
  round.weight_moment.z() = link.weight_moment.z();
  round.inertia(0, 0) = round.inertia(1, 1) = link.inertia(1, 1);
  return round;
}

}  // namespace

ChainModel WithBaseInertialParameters(const ChainModel& chain) {
  ChainModel out = chain;
  for (int i = chain.n - 1; i >= 0; --i) {
    JointModel& joint = out.joints[i];
    if (joint.slide) continue;
    const LinkInertia round = RoundPart(joint.link);
    joint.link -= round;
    if (i > 0) out.joints[i - 1].link += InFrame(joint.fixed.inverse(), round);
  }
  return out;
}

}  // namespace robocell::internal
