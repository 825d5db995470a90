#include "robocell/env/target_lead.h"

#include <algorithm>
#include <cmath>

#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

Vector3d ShiftBetween(const Pose& from, const Pose& to) {
  return to.translation() - from.translation();
}

Vector3d TurnBetween(const Pose& from, const Pose& to) {
  return Pose(Vector3d::Zero(),
              QuaternionProduct(to.quaternion(), QuaternionInverse(from.quaternion())))
      .rotvec();
}

// Returns the part of `pending` by which the target is `ahead`: it keeps the direction of the
// command.
double Outstanding(double pending, double ahead) {
  return pending * ahead > 0 ? std::copysign(std::min(std::abs(pending), std::abs(ahead)), pending)
                             : 0;
}

// Adds the distance by which the arm was pushed away: it `moved` against the pending motion.
double WithPush(double pending, double moved) {
  return pending * moved < 0 ? pending - moved : pending;
}

// Returns how far the target is ahead of all positions that the arm counts as having.
double AheadOf(double sent, std::initializer_list<double> places) {
  return sent - std::clamp(sent, std::min(places), std::max(places));
}

// Returns the lead that remains for an action that moves by `forth` along it.
double LeadFor(double lead, double forth) { return std::max(0.0, lead + std::min(forth, 0.0)); }

// All relative to the arm's position. Returns the displacement to take back, and removes it from
// `pending`.
Vector3d TakeBack(const Vector3d& sent, const Led<Vector3d>& led, double lead,
                  std::array<double, 3>& pending, const std::array<double, 3>& action) {
  Vector3d ahead, unexplained;
  for (Eigen::Index i = 0; i < 3; ++i) {
    double& sum = pending[static_cast<size_t>(i)];
    sum = Outstanding(WithPush(sum, -led.before[i]), AheadOf(sent[i], {0.0, led.rest[i]}));
    ahead[i] = AheadOf(sent[i], {0.0, led.rest[i], led.steady[i]});
    unexplained[i] = Outstanding(sum, ahead[i]);
  }
  const double length = unexplained.norm();
  if (!(length > 0)) return Vector3d::Zero();
  const double forth = Eigen::Map<const Vector3d>(action.data()).dot(unexplained) / length;
  const double excess = ahead.dot(unexplained) / length - LeadFor(lead, forth);
  if (!(excess > 0)) return Vector3d::Zero();
  const Vector3d back = std::min(1.0, excess / length) * unexplained;
  Eigen::Map<Vector3d>(pending.data()) -= back;
  return back;
}

}  // namespace

void AddMove(PendingMove& move, const Pose& from, const Pose& to) {
  Eigen::Map<Vector3d>(move.shift.data()) += ShiftBetween(from, to);
  Eigen::Map<Vector3d>(move.turn.data()) += TurnBetween(from, to);
}

Pose WithinLead(const Pose& sent, const Led<Pose>& led, const StepLimit& lead, PendingMove& pending,
                const PendingMove& action) {
  const auto back_of = [&](const auto& between, double most, std::array<double, 3>& moves,
                           const std::array<double, 3>& next) {
    const auto from_arm = [&](const Pose& to) -> Vector3d { return between(led.present, to); };
    const Led<Vector3d> own = {from_arm(led.before), Vector3d::Zero(), from_arm(led.rest),
                               from_arm(led.steady)};
    return TakeBack(from_arm(sent), own, most, moves, next);
  };
  const Vector3d shift = back_of(ShiftBetween, lead.translation, pending.shift, action.shift);
  const Vector3d turn = back_of(TurnBetween, lead.rotation, pending.turn, action.turn);
  if (shift.isZero(0) && turn.isZero(0)) return sent;
  const Pose back = Pose::FromRotvec(Vector3d::Zero(), -turn);
  return Pose(sent.translation() - shift, QuaternionProduct(back.quaternion(), sent.quaternion()));
}

double WithinJointLead(double sent, const Led<double>& led, double lead, double& pending,
                       double action) {
  pending = Outstanding(WithPush(pending, led.present - led.before),
                        AheadOf(sent, {led.present, led.rest}));
  const double ahead = AheadOf(sent, {led.present, led.rest, led.steady});
  const double unexplained = Outstanding(pending, ahead);
  const double excess = std::abs(ahead) - LeadFor(lead, std::copysign(action, action * ahead));
  if (!(excess > 0)) return sent;
  const double back = std::copysign(std::min(excess, std::abs(unexplained)), unexplained);
  pending -= back;
  return sent - back;
}

bool TakeBackJoints(std::span<double> sent, std::span<const Led<double>> led,
                    std::span<const double> leads, std::span<double> pending) {
  const auto unexplained = [&](size_t i) {
    const Led<double>& l = led[i];
    return Outstanding(pending[i], AheadOf(sent[i], {l.present, l.rest, l.steady}));
  };
  double share = 0;
  for (size_t i = 0; i < sent.size(); ++i) {
    const Led<double>& l = led[i];
    pending[i] = Outstanding(WithPush(pending[i], l.present - l.before),
                             AheadOf(sent[i], {l.present, l.rest}));
    const double most = std::abs(unexplained(i));
    if (most > leads[i]) share = std::max(share, 1 - leads[i] / most);
  }
  if (share == 0) return false;
  for (size_t i = 0; i < sent.size(); ++i) {
    const double back = share * unexplained(i);
    sent[i] -= back;
    pending[i] -= back;
  }
  return true;
}

}  // namespace robocell::internal
