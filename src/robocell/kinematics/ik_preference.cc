#include "robocell/kinematics/ik_preference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/start_range.h"

namespace robocell::internal {
namespace {

constexpr double kPart = 0.3;
// Factor of the gradient of log manipulability that sets the next goal, and the largest step to it,
// rad or lengths of the chain.
constexpr double kUphill = 0.3, kFarthestUphill = 0.5;

bool IsLimited(const JointModel& joint) {
  return std::isfinite(joint.lower) && std::isfinite(joint.upper) && joint.lower < joint.upper;
}

}  // namespace

IkPreference::IkPreference(const ChainModel& chain, const IkOptions& options)
    : chain_(chain), options_(options), prefer_(options.prefer) {}

double IkPreference::largest_squared_scale() const {
  double largest = squared_scale(0);
  for (int i = 1; i < chain_.n; ++i) largest = std::max(largest, squared_scale(i));
  return largest;
}

JointVector IkPreference::GoalFor(const JointVector& seed) const {
  JointVector goal = seed;
  for (int i = 0; i < chain_.n; ++i) {
    const JointModel& joint = chain_.joints[i];
    if (options_.locked[i]) continue;
    if (prefer_ == IkPrefer::kPosture)
      goal[i] = std::clamp(options_.posture[i], joint.lower, joint.upper);
    // Not the middle of a start range: hinges may have several turns.
    if (prefer_ == IkPrefer::kAwayFromLimits && IsLimited(joint))
      goal[i] = 0.5 * (joint.lower + joint.upper);
  }
  return goal;
}

// The weight that makes joints of different ranges comparable. Away from limits a joint counts by
// the square of its share of the half range (A. Liegeois, "Automatic Supervisory Control of the
// Configuration and Behavior of Multibody Mechanisms", 1977).
double IkPreference::squared_scale(int i) const {
  const JointModel& joint = chain_.joints[i];
  const bool by_range = prefer_ == IkPrefer::kAwayFromLimits && IsLimited(joint);
  const double scale = by_range ? 0.5 * (joint.upper - joint.lower) / UnitOf(chain_, i)
                       : prefer_ == IkPrefer::kAwayFromLimits && !joint.slide ? std::numbers::pi
                                                                              : 1;
  return scale * scale;
}

bool IkPreference::counts(int i) const {
  return prefer_ != IkPrefer::kAwayFromLimits || IsLimited(chain_.joints[i]);
}

double IkPreference::part(int i) const {
  return any() && counts(i) && !options_.locked[i] ? kPart : 0;
}

JointVector IkPreference::GoalFrom(const JointVector& q, const JointVector& goal) const {
  return prefer_ == IkPrefer::kManipulability ? Uphill(q) : goal;
}

JointVector IkPreference::Uphill(const JointVector& q) const {
  std::array<double, kMaxChainJoints> slope;
  LogManipulabilityGradient(chain_, q.data(), slope.data());
  JointVector goal = q;
  for (int i = 0; i < chain_.n; ++i) {
    if (options_.locked[i]) continue;
    const JointModel& joint = chain_.joints[i];
    const double unit = UnitOf(chain_, i);
    const double step = std::clamp(kUphill * unit * slope[i], -kFarthestUphill, kFarthestUphill);
    goal[i] = std::clamp(q[i] + unit * step, joint.lower, joint.upper);
  }
  return goal;
}

double IkPreference::Cost(const JointVector& q, const JointVector& goal) const {
  if (prefer_ == IkPrefer::kManipulability) return -ManipulabilityOf(chain_, q.data());
  double sum = 0;
  for (int i = 0; i < chain_.n; ++i) {
    const double off = counts(i) ? (q[i] - goal[i]) / UnitOf(chain_, i) : 0;
    sum += off * off / squared_scale(i);
  }
  return sum;
}

}  // namespace robocell::internal
