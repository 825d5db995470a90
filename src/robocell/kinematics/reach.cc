#include "robocell/kinematics/reach.h"

#include <algorithm>
#include <utility>

#include "robocell/kinematics/chain_cache.h"
#include "robocell/kinematics/low_discrepancy.h"
#include "robocell/kinematics/start_range.h"

namespace robocell {

namespace {

constexpr int kSamples = 2048;
constexpr int kImproved = 4;  // best samples that are improved
constexpr double kFinestStep = 1e-3;

class ReachSearch {
 public:
  explicit ReachSearch(const ChainModel& chain) : chain_(chain) {
    for (int i = 0; i < chain_.n; ++i)
      ranges_[i] = internal::StartRangeOf(chain_.joints[i], chain_.length);
  }

  double Run() const {
    std::array<std::pair<double, int>, kSamples> samples;  // distance, index
    for (int k = 0; k < kSamples; ++k) samples[k] = {Distance(Sample(k)), k};
    std::partial_sort(samples.begin(), samples.begin() + kImproved, samples.end(),
                      std::greater<>());
    double best = 0;
    for (int k = 0; k < kImproved; ++k) best = std::max(best, Improve(Sample(samples[k].second)));
    return best;
  }

 private:
  JointVector Sample(int k) const {
    JointVector q(chain_.n);
    for (int i = 0; i < chain_.n; ++i) q[i] = ranges_[i].at(internal::LowDiscrepancy(k, i));
    return q;
  }

  double Distance(const JointVector& q) const {
    return WalkChain(chain_, q.data(), [](int, const Transform&) {}).translation.norm();
  }

  // Moves one joint after the other as long as that leads farther out, in ever finer steps.
  double Improve(JointVector q) const {
    double best = Distance(q);
    for (double part = 0.1; part > kFinestStep; part *= 0.5) {
      for (bool moved = true; moved;) {
        moved = false;
        for (int i = 0; i < chain_.n; ++i) moved = MoveJointOut(i, part, &q, &best) || moved;
      }
    }
    return best;
  }

  bool MoveJointOut(int i, double part, JointVector* q, double* best) const {
    const internal::StartRange& range = ranges_[i];
    for (const double sign : {-1.0, 1.0}) {
      JointVector moved = *q;
      moved[i] = std::clamp(moved[i] + sign * part * (range.upper - range.lower), range.lower,
                            range.upper);
      const double distance = Distance(moved);
      if (distance <= *best + 1e-9) continue;
      *q = moved;
      *best = distance;
      return true;
    }
    return false;
  }

  const ChainModel& chain_;
  std::array<internal::StartRange, kMaxChainJoints> ranges_;
};

}  // namespace

double ApproximateReach(const Chain& chain) {
  static internal::ChainCache<double> cache;
  return *cache.Get(chain.model(), [&] { return ReachSearch(chain.model()).Run(); });
}

}  // namespace robocell
