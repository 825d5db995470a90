#include "robocell/kinematics/ik_step.h"

#include <cmath>

#include "robocell/kinematics/chain_model.h"

namespace robocell {
namespace {

// If the search from the present joint values fails, others begin; for an unreachable target that
// should not take long.
constexpr int kOtherStarts = 32;

bool IsNear(const ChainModel& chain, std::span<const double> q, std::span<const double> from,
            double most) {
  for (int i = 0; i < chain.n; ++i) {
    if (std::abs(q[i] - from[i]) > most * UnitOf(chain, i)) return false;
  }
  return true;
}

}  // namespace

double LargestJointStep(const Chain& chain, const Pose& from, const Pose& to) {
  const double lengths = (to.translation() - from.translation()).norm() / chain.model().length;
  const double angle = AngleBetween(from.quaternion(), to.quaternion());
  return kLeastJointStep + kJointStepGain * (lengths + angle);
}

IkResult IkStep(const Chain& chain, const Pose& tip_in_base, std::span<const double> from) {
  const JointVector seed(from);
  const IkResult first = Ik(chain, tip_in_base, {.seed = seed, .max_restarts = 0});
  const double most = LargestJointStep(chain, chain.Fk(from), tip_in_base);
  if (first.success && IsNear(chain.model(), first.q, from, most)) return first;
  const auto n = static_cast<size_t>(chain.n_joints());
  const auto keep_near = [&](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (size_t k = 0; k < static_cast<size_t>(count); ++k)
      keep[k] = IsNear(chain.model(), q.subspan(k * n, n), from, most) ? 1 : 0;
  };
  return Ik(
      chain, tip_in_base,
      {.seed = seed, .prefer = IkPrefer::kSeed, .filter = keep_near, .max_restarts = kOtherStarts});
}

}  // namespace robocell
