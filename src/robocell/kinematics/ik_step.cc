#include "robocell/kinematics/ik_step.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/differential_ik.h"
#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

// If the search from the present joint values fails, others begin; an unreachable target should not
// take long.
constexpr int kOtherStarts = 32;

bool IsNear(const ChainModel& chain, std::span<const double> q, std::span<const double> from,
            double most) {
  for (int i = 0; i < chain.n; ++i) {
    if (std::abs(q[i] - from[i]) > most * UnitOf(chain, i)) return false;
  }
  return true;
}

// Largest motion of the tip in one damped step, rad and chain lengths, and the largest number of
// steps of one search and of all searches together. A step of seven joints takes about three
// microseconds.
constexpr double kDampedStep = 0.02;
constexpr int kDampedSteps = 60, kDampedStepsInAll = 360;
// The share of the pose error that each step, and all of them together, must remove.
constexpr double kShareOfStep = 1e-3, kShareInAll = 0.02;
// If the joints are singular to first order, for example in a stretched arm that is to bend, the
// search begins beside them: one joint is moved by one of these, rad or chain lengths. The larger
// ones are tried only if the smallest does not help: they pass the singular place, for an arm that
// rests at a limit on the side of it without room.
constexpr double kAside[] = {0.05, 0.15, 0.3};
constexpr int kAsides = 2 * std::size(kAside);  // displacements of a joint, to both sides
// A search that removes less of the pose error than this share is compared with others, until one
// removes as much and leaves every joint this far from its limits, rad or chain lengths.
constexpr double kGoodShare = 0.5, kGoodRoom = 0.1;
constexpr double kLeastLengthShare = 0.02;  // of the chain, see LengthPerRadian
constexpr double kNoRoom = 1e-12;           // the speed of a joint that has used up its range

struct Remaining {
  Twist twist;          // twist to the target, in base axes
  double size = 0;      // weighed, rad
  double distance = 0;  // rad and chain lengths
};

Twist TwistBetween(const Pose& tip, const Pose& target) {
  const Pose turn(Eigen::Vector3d::Zero(),
                  QuaternionProduct(target.quaternion(), QuaternionInverse(tip.quaternion())));
  return {target.translation() - tip.translation(), turn.rotvec()};
}

// Returns how far the joint that is nearest to a limit may still go, rad or chain lengths.
double RoomOf(const ChainModel& chain, std::span<const double> q) {
  double room = std::numeric_limits<double>::infinity();
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& limits = chain.joints[i];
    room = std::min(
        {room, (q[i] - limits.lower) / UnitOf(chain, i), (limits.upper - q[i]) / UnitOf(chain, i)});
  }
  return room;
}

class DampedSearch {
 public:
  DampedSearch(const Chain& chain, const Pose& target, std::span<const double> from)
      : chain_(chain),
        target_(target),
        from_(from),
        most_(LargestJointStep(chain, chain.Fk(from), target)) {
    options_.length = LengthPerRadian(chain, chain.Fk(from), target);
    options_.seconds = 1;
    options_.max_speed = JointVector(chain.n_joints());
  }

  Remaining LeftAt(std::span<const double> q) const {
    const Twist twist = TwistBetween(chain_.Fk(q), target_);
    const double linear = twist.linear.norm(), angular = twist.angular.norm();
    return {twist, std::hypot(linear / options_.length, angular),
            std::hypot(linear / chain_.model().length, angular)};
  }

  // Moves from `q` towards the target as long as the steps come nearer.
  Remaining GoFrom(JointVector& q) {
    Remaining left = LeftAt(q);
    JointVector next = q;
    for (int step = 0; step < kDampedSteps && left.size > 0 && steps_left_ > 0; ++step) {
      --steps_left_;
      LimitSpeeds(q);
      const double share = std::min(1.0, kDampedStep / left.distance);
      const Twist part{left.twist.linear * share, left.twist.angular * share};
      const DifferentialIkResult moved = DifferentialIk(chain_, q, part, options_);
      for (int i = 0; i < q.size(); ++i) next[i] = q[i] + moved.velocity[i];
      const Remaining now = LeftAt(next);
      if (now.size > left.size * (1 - kShareOfStep)) break;
      q = next;
      left = now;
    }
    return left;
  }

 private:
  // Limits the step's second so that no joint moves too far from its initial position.
  void LimitSpeeds(const JointVector& q) {
    for (int i = 0; i < q.size(); ++i) {
      const double most = most_ * UnitOf(chain_.model(), i);
      options_.max_speed[i] = std::max(most - std::abs(q[i] - from_[i]), kNoRoom);
    }
  }

  const Chain& chain_;
  const Pose& target_;
  const JointVector from_;
  const double most_;
  int steps_left_ = kDampedStepsInAll;
  DifferentialIkOptions options_;
};

}  // namespace

double LengthPerRadian(const Chain& chain, const Pose& from, const Pose& to) {
  const Twist displacement = TwistBetween(from, to);
  const double turn = displacement.angular.norm(), length = chain.model().length;
  if (turn == 0) return length;
  return std::clamp(displacement.linear.norm() / turn, kLeastLengthShare * length, length);
}

double LargestJointStep(const Chain& chain, const Pose& from, const Pose& to) {
  const double lengths = (to.translation() - from.translation()).norm() / chain.model().length;
  const double angle = AngleBetween(from.quaternion(), to.quaternion());
  return kLeastJointStep + kJointStepGain * (lengths + angle);
}

IkResult IkStep(const Chain& chain, const Pose& tip_in_base, std::span<const double> from,
                const IkOptions& task, std::optional<double> most) {
  IkOptions options{.seed = JointVector(from),
                    .position_only = task.position_only,
                    .position_weights = task.position_weights,
                    .rotation_weights = task.rotation_weights,
                    .axis = task.axis,
                    .cone = task.cone,
                    .max_restarts = 0};
  const IkResult first = Ik(chain, tip_in_base, options);
  const double limit = most ? *most : LargestJointStep(chain, chain.Fk(from), tip_in_base);
  if (first.success && IsNear(chain.model(), first.q, from, limit)) return first;
  const auto n = static_cast<size_t>(chain.n_joints());
  options.prefer = IkPrefer::kSeed;
  options.max_restarts = kOtherStarts;
  options.filter = [&chain, from, limit, n](std::span<const double> q, int count,
                                            std::span<uint8_t> keep) {
    for (size_t k = 0; k < static_cast<size_t>(count); ++k)
      keep[k] = IsNear(chain.model(), q.subspan(k * n, n), from, limit) ? 1 : 0;
  };
  return Ik(chain, tip_in_base, options);
}

IkResult IkTowards(const Chain& chain, const Pose& tip_in_base, std::span<const double> from) {
  chain.RequireJointValues("inverse kinematics towards a pose", from);
  RequireIkTarget(tip_in_base, "inverse kinematics towards a pose");
  DampedSearch search(chain, tip_in_base, from);
  const double start = search.LeftAt(from).size;
  const double enough = (1 - kShareInAll) * start;
  IkResult result{.q = JointVector(from)};
  Remaining left = search.GoFrom(result.q);
  const double good = (1 - kGoodShare) * start;
  const bool compare = left.size > good;
  double room = RoomOf(chain.model(), result.q);
  for (int k = 0; compare && k < kAsides * chain.n_joints(); ++k) {
    // The smaller steps aside of all joints come before the larger ones.
    const double aside = kAside[k / (2 * chain.n_joints())];
    const int joint = k / 2 % chain.n_joints();
    if (left.size <= good && room >= kGoodRoom) break;
    if (joint == 0 && k % 2 == 0 && left.size <= enough) break;
    JointVector q(from);
    const JointModel& limits = chain.model().joints[joint];
    q[joint] = std::clamp(q[joint] + (k % 2 ? -aside : aside) * UnitOf(chain.model(), joint),
                          limits.lower, limits.upper);
    const Remaining now = search.GoFrom(q);
    // Both sides of a singular place may lead equally far. The next step needs joints that can
    // still move on.
    const double here = RoomOf(chain.model(), q);
    const double gain = left.size - now.size;
    if (gain < -kShareInAll * start || (gain <= kShareInAll * start && here <= room)) continue;
    result.q = q;
    left = now;
    room = here;
  }
  result.success = left.size <= enough;
  result.position_error = left.twist.linear.norm();
  result.rotation_error = left.twist.angular.norm();
  return result;
}

}  // namespace robocell::internal
