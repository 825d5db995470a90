#include "robocell/kinematics/lane_work.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robocell::internal {
namespace {

// The kernel's sums round differently from the judge's.
constexpr double kPartOfTolerance = 0.999;
// Remaining part of the squared error after a step, in chain lengths and radians.
constexpr double kLeftOfSquare = 0.5;
// Number of steps of a start: few at first, because most arrive in six; more after many failures.
constexpr int StepsOf(int start) { return start < 4 ? 12 : start < 12 ? 20 : 40; }
// After this many steps a start with a larger cost (squared error) is hopeless; not for the starts
// after the first few, whose targets lie in corners.
constexpr int kFirstLook = 5, kSecondLook = 8, kStartsLookedAt = 8;
constexpr double kFirstCost = 0.1, kSecondCost = 1e-4;
// A cone with at most this angle, rad, is first approached at its axis: its border bends as sharply
// as it is narrow, and takes many steps.
constexpr double kNarrowCone = 0.05;
// Joints with a smaller range than this (rad, lengths of the chain) take part in a step by the
// square of their range. They reach a limit at once, and the step lacks their expected motion.
constexpr double kNarrow = 0.1;
// Targets are pulled in to this many reaches from the root: the direction to the nearest point is
// the same.
constexpr double kMostReaches = 1.5;
// They are also pulled in to these lengths of the chain, and metres, so that no number overflows.
constexpr double kMostLengths = 1e9, kMostMetres = 1e100;

}  // namespace

LaneWork::LaneWork(const Chain& chain, const IkOptions& options)
    : original_(chain),
      chain_(chain.model()),
      lane_chain_(chain.lanes()),
      folded_(lane_chain_.folded()),
      options_(options),
      task_(options),
      preference_(chain_, options) {
  const double tolerance = options.tolerance * kPartOfTolerance;
  limits_.distance2 = std::pow(tolerance * folded_.per_metre, 2);
  limits_.turn2 = tolerance * tolerance;
  likely_cost_ = tolerance * std::min(1.0, folded_.per_metre) / kLeftOfSquare;
  for (int i = 0; i < chain_.n; ++i) {
    limits_.locked[i] = options.locked[i];
    any_locked_ |= options.locked[i];
  }
  bool any_narrow = false;
  for (int i = 0; i < chain_.n; ++i) any_narrow |= ShareOf(i) < 1;
  settles_ = preference_.any() && task_.leaves_joints(chain_.n, options.locked);
  if (task_.plain && !settles() && !any_narrow) return;
  Clear(0, LanesOfOneQuery());  // lanes with a task are always stepped with others
  lane_task_.emplace();
  lane_task_->swing = task_.swing;
  const Eigen::Vector3d axis = chain_.last_to_tip.rotation * task_.axis;
  std::copy(axis.begin(), axis.end(), lane_task_->axis);
  lane_task_->cone = std::tan(0.5 * task_.cone);
  for (int i = 0; i < chain_.n; ++i) {
    lane_task_->part[i] = preference_.part(i);
    lane_task_->share[i] = ShareOf(i);
    lane_task_->ease[i] = preference_.ease(i) * lane_task_->share[i];
  }
}

double LaneWork::ShareOf(int joint) const {
  const FoldedJoint& limits = folded_.joints[joint];
  const double room = (limits.upper - limits.lower) * (limits.slide ? folded_.per_metre : 1);
  return room < kNarrow ? std::pow(room / kNarrow, 2) : 1;
}

JointVector LaneWork::SeedOf(std::span<const double> seed) const {
  return seed.empty() ? lane_chain_.middle()
                      : robocell::internal::SeedOf(chain_, seed, options_.locked);
}

void LaneWork::Clear(int first, int end) {
  const auto clear = [&](double(&row)[kMaxLanes]) { std::fill(row + first, row + end, 0.0); };
  for (int i = 0; i < chain_.n; ++i) clear(state_.q[i]), clear(state_.best_q[i]);
  for (auto& row : state_.axes) clear(row);
  for (auto& row : state_.position) clear(row);
  clear(state_.roam);
  clear(state_.distance2);
  clear(state_.turn2);
  clear(state_.best_cost);
}

// Flattened: a call of a matrix product costs more than the product.
[[gnu::flatten]] void LaneWork::Aim(int lane, const Transform& tip_in_base) {
  state_.best_cost[lane] = std::numeric_limits<double>::infinity();
  Transform tip = tip_in_base;
  tip.translation = tip.translation.cwiseMax(-kMostMetres).cwiseMin(kMostMetres);
  const Transform target = chain_.joints[0].fixed.inverse() * tip;
  const Eigen::Matrix3d axes = target.rotation * chain_.last_to_tip.rotation.transpose();
  for (int i = 0; i < 9; ++i) state_.axes[i][lane] = axes.data()[i];
  Eigen::Vector3d position = target.translation * folded_.per_metre;
  // Locked joints may be beyond the limits, and so beyond the reach.
  const double reach = any_locked_ ? kMostLengths : chain_.reach_bound * folded_.per_metre;
  // Does not apply along an axis that may have any value.
  const double most = task_.whole_position ? kMostReaches * reach : kMostLengths;
  const double far = std::min(most, kMostLengths);
  // The squares of the numbers may overflow.
  if (!(position.squaredNorm() <= far * far)) {
    const double distance = position.stableNorm();
    if (distance > far) position *= far / distance;
  }
  for (int i = 0; i < 3; ++i) state_.position[i][lane] = position[i];
  if (lane_task_) AimTask(lane, target.rotation);
}

void LaneWork::AimTask(int lane, const Eigen::Matrix3d& target_axes) {
  const Eigen::Matrix3d linear = task_.linear * target_axes.transpose(),
                        angular = task_.angular * target_axes.transpose();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      lane_task_->linear[3 * r + c][lane] = linear(r, c);
      lane_task_->angular[3 * r + c][lane] = angular(r, c);
    }
  }
  lane_task_->pull[lane] = 0;
}

void LaneWork::AskFor(int lane, int start) {
  if (task_.cone == 0) return;
  // Alternates, so that a cone is reached wherever its axis is reachable, and at its border too; a
  // narrow cone is hardly ever reachable only at its border.
  const bool to_axis = task_.cone <= kNarrowCone ? start % 4 != 3 : start % 2 == 1;
  lane_task_->to_axis[lane] = to_axis ? 1 : 0;
}

void LaneWork::Pull(int lane, const JointVector& goal) {
  lane_task_->to_axis[lane] = 0;  // redundant joints may use the whole cone
  for (int i = 0; i < chain_.n; ++i) lane_task_->goal[i][lane] = goal[i];
  lane_task_->pull[lane] = 1;
}

template <class Number>
void LaneWork::Put(int lane, const Number* q) {
  const bool is_best = std::isinf(state_.best_cost[lane]);
  state_.roam[lane] = 0;
  for (int i = 0; i < chain_.n; ++i) {
    const FoldedJoint& joint = folded_.joints[i];  // the kernel reads it too
    double value = q[i];
    if (!options_.locked[i]) value = std::clamp(value, joint.lower, joint.upper);
    state_.q[i][lane] = value;
    if (is_best) state_.best_q[i][lane] = value;
  }
}
template void LaneWork::Put(int lane, const double* q);
template void LaneWork::Put(int lane, const float* q);

void LaneWork::LetRoam(int lane) { state_.roam[lane] = std::numeric_limits<double>::infinity(); }

JointVector LaneWork::Taken(const double (&rows)[kMaxChainJoints][kMaxLanes], int lane,
                            const JointVector& seed) const {
  JointVector q = seed;
  for (int i = 0; i < chain_.n; ++i) {
    if (!options_.locked[i]) q[i] = rows[i][lane];
  }
  UnwindTowards(folded_, seed, options_.locked, &q);
  return q;
}

bool LaneWork::IsHopeless(int lane, int start, int age) const {
  if (age > std::min(options_.max_iterations, StepsOf(start))) return true;
  if (start >= kStartsLookedAt) return false;
  return (age == kFirstLook && cost(lane) > kFirstCost) ||
         (age == kSecondLook && cost(lane) > kSecondCost);
}

const StartTable* LaneWork::table() const {
  return any_locked_ ? nullptr : &lane_chain_.starts(chain_);
}

int LaneWork::RestartsFor(const Transform& tip_in_base) const {
  return robocell::internal::RestartsFor(chain_, task_, options_, tip_in_base);
}

int LaneWork::MoreRestartsFor(const Transform& tip_in_base, double best_cost) const {
  return robocell::internal::MoreRestartsFor(chain_, task_, options_, tip_in_base, best_cost);
}

}  // namespace robocell::internal
