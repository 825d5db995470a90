#include "robocell/env/target_lead.h"

#include <algorithm>
#include <cmath>

#include "robocell/math/rotation.h"

namespace robocell {
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

// The least share of `pending` that has to be taken from `ahead` for its length to be `most`, or as
// near to that as it gets.
double ShareToTakeBack(const Vector3d& ahead, const Vector3d& pending, double most) {
  const double excess = ahead.squaredNorm() - most * most, length = pending.squaredNorm();
  const double along = ahead.dot(pending);
  if (!(excess > 0) || !(along > 0)) return 0;
  const double root = along * along - length * excess;
  return std::min(1.0, (along - std::sqrt(std::max(root, 0.0))) / length);
}

void KeepWithin(double share, std::array<double, 3>& pending) {
  for (double& x : pending) x *= share;
}

}  // namespace

void PendingMove::Add(const Pose& from, const Pose& to) {
  Eigen::Map<Vector3d>(shift.data()) += ShiftBetween(from, to);
  Eigen::Map<Vector3d>(turn.data()) += TurnBetween(from, to);
}

Pose WithinLead(const Pose& sent, const Pose& steady, const Pose& present, const StepLimit& lead,
                PendingMove& pending) {
  const Vector3d shift(pending.shift.data()), turn(pending.turn.data());
  double shift_share = 1, turn_share = 1;
  bool shift_done = false, turn_done = false;
  for (const Pose* arm : {&steady, &present}) {
    const Vector3d shift_ahead = ShiftBetween(*arm, sent), turn_ahead = TurnBetween(*arm, sent);
    shift_share = std::min(shift_share, ShareToTakeBack(shift_ahead, shift, lead.translation));
    turn_share = std::min(turn_share, ShareToTakeBack(turn_ahead, turn, lead.rotation));
    shift_done = shift_done || shift_ahead.norm() <= lead.translation;
    turn_done = turn_done || turn_ahead.norm() <= lead.rotation;
  }
  KeepWithin(shift_done ? 0 : 1 - shift_share, pending.shift);
  KeepWithin(turn_done ? 0 : 1 - turn_share, pending.turn);
  if (shift_share == 0 && turn_share == 0) return sent;
  const Pose back = Pose::FromRotvec(Vector3d::Zero(), -turn_share * turn);
  return Pose(sent.translation() - shift_share * shift,
              QuaternionProduct(back.quaternion(), sent.quaternion()));
}

double WithinJointLead(double sent, double steady, double present, double lead, double& pending) {
  const double nearest = std::clamp(sent, std::min(steady, present), std::max(steady, present));
  const double ahead = sent - nearest, excess = std::abs(ahead) - lead;
  if (excess <= 0) {
    pending = 0;
    return sent;
  }
  if (ahead * pending <= 0) return sent;
  const double back = std::copysign(std::min(excess, std::abs(pending)), pending);
  pending -= back;
  return sent - back;
}

}  // namespace robocell
