#include "robocell/kinematics/ik_parts.h"

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/low_discrepancy.h"
#include "robocell/kinematics/pose_error.h"
#include "robocell/kinematics/start_range.h"

namespace robocell::internal {

namespace {

// Beyond this number too few digits are left for an angle.
constexpr double kMostTurns = 1e5;
constexpr double kLessThanHalfATurn = 3;  // rad

constexpr int kRestartsWhenTooFar = 8;
// Nine in ten of the reachable targets that all restarts miss are missed by less than this, and one
// in eleven of the unreachable ones inside the reach.
constexpr double kNearMiss = 0.01;
constexpr int kRestartsAfterANearMiss = 400;

bool IsOutOfReach(const ChainModel& chain, const Transform& target, double tolerance) {
  const Eigen::Vector3d& root = chain.joints[0].fixed.translation;
  return (target.translation - root).norm() > chain.reach_bound + tolerance;
}

// A locked slide may be beyond its limits; the position of a hinge does not change the chain's
// length.
bool MayExceedReach(const ChainModel& chain, const LockedJoints& locked) {
  for (int i = 0; i < chain.n; ++i) {
    if (locked[i] && chain.joints[i].slide) return true;
  }
  return false;
}

// Returns the length of a vector whose square may overflow.
double Length(const Eigen::Vector3d& v) {
  const double square = v.squaredNorm();
  return square > 1e-200 && square < 1e200 ? std::sqrt(square) : v.stableNorm();
}

Transform TipAt(const Chain& chain, const JointVector& q) {
  LinkAnswer answer;
  ComputeChain(chain, LinkPart::kTip, {.q = q.data()}, &answer);
  return TipOf(answer);
}

bool IsInside(const FoldedJoint& joint, double q) { return q >= joint.lower && q <= joint.upper; }

// Returns the position within the limits, whole turns away from q, that is nearest to the seed.
double TurnedTowards(double seed, double q, const FoldedJoint& joint) {
  double turns = std::round((seed - q) / kTurn);
  if (!(std::abs(turns) <= kMostTurns)) turns = 0;
  // Because the seed is within the limits, the nearest position is at most half a turn beyond.
  const double nearest = q + turns * kTurn;
  if (nearest > joint.upper) turns -= 1;
  if (nearest < joint.lower) turns += 1;
  // Rounding can cross limits that are exactly a turn apart.
  const double turned = q + turns * kTurn;
  return turned >= joint.lower ? std::min(turned, joint.upper) : joint.lower;  // not NaN
}

}  // namespace

JointVector SeedOf(const ChainModel& chain, std::span<const double> seed,
                   const LockedJoints& locked) {
  JointVector q = seed.empty() ? JointVector(chain.n) : JointVector(seed);
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& joint = chain.joints[i];
    if (seed.empty()) q[i] = StartRangeOf(joint, chain.length).middle();
    if (!locked[i]) q[i] = std::clamp(q[i], joint.lower, joint.upper);
  }
  return q;
}

JointVector SpreadStart(const ChainModel& chain, const JointVector& seed,
                        const LockedJoints& locked, int k, double part) {
  JointVector q = seed;
  for (int i = 0; i < chain.n; ++i) {
    if (locked[i]) continue;
    const JointModel& joint = chain.joints[i];
    const double anywhere = StartRangeOf(joint, chain.length).at(LowDiscrepancy(k, i));
    q[i] = std::clamp(seed[i] + part * (anywhere - seed[i]), joint.lower, joint.upper);
  }
  return q;
}

int RestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                const Transform& target) {
  const bool too_far = task.whole_position && !MayExceedReach(chain, options.locked) &&
                       IsOutOfReach(chain, target, options.tolerance);
  return too_far ? std::min(options.max_restarts, kRestartsWhenTooFar) : options.max_restarts;
}

int MoreRestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                    const Transform& target, double best_cost) {
  if (best_cost > kNearMiss || options.max_restarts < IkOptions().max_restarts) return 0;
  if (task.joints_to_spare(chain.n, options.locked) < 0) return 0;
  const bool too_far = RestartsFor(chain, task, options, target) < options.max_restarts;
  return too_far ? 0 : kRestartsAfterANearMiss;
}

void UnwindTowards(const FoldedChain& chain, const JointVector& seed, const LockedJoints& locked,
                   JointVector* q) {
  for (int i = 0; i < chain.n; ++i) {
    const FoldedJoint& joint = chain.joints[i];
    if (joint.slide || joint.leads || locked[i]) continue;
    double& value = (*q)[i];
    const bool near = std::abs(seed[i] - value) < kLessThanHalfATurn;
    if (!near || !IsInside(joint, value)) value = TurnedTowards(seed[i], value, joint);
  }
}

// Flattened: a call of a matrix product costs more than the product.
[[gnu::flatten]] IkResult Judged(const Chain& chain, const Transform& target, const IkTask& task,
                                 double tolerance, const JointVector& q) {
  IkResult result{.q = q};
  const Transform tip = TipAt(chain, q);
  if (task.plain) {
    result.position_error = Length(target.translation - tip.translation);
    result.rotation_error = RotationAngle(target.rotation * tip.rotation.transpose());
  } else {
    const IkTask::Errors errors = task.ErrorsOf(target, tip);
    result.position_error = errors.position;
    result.rotation_error = errors.rotation;
  }
  result.success = result.position_error <= tolerance &&
                   (task.position_only || result.rotation_error <= tolerance);
  return result;
}

}  // namespace robocell::internal
