#include "robocell/kinematics/lane_solver.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/lane_kernel.h"

namespace robocell {
namespace {

// The kernel's sums are rounded otherwise than the judge's.
constexpr double kPartOfTolerance = 0.999;
// As many starts come from the table; a target that these do not reach lies in a corner.
constexpr int kStartsNearby = 16;
// Steps that a start is given: few at first, as most get there in six; more where many failed.
constexpr int StepsOf(int start) { return start < 4 ? 12 : start < 12 ? 20 : 40; }
// After so many steps a start with a larger cost (squared error) is hopeless; not for the starts
// after the first few.
constexpr int kFirstLook = 5, kSecondLook = 8, kLookedAt = 8;
constexpr double kFirstCost = 0.1, kSecondCost = 1e-4;
// Targets are pulled in to this many reaches from the root: the way to the nearest point is the
// same, and no number overflows.
constexpr double kMostReaches = 1.5, kMostLengths = 1e3;

struct Lane {
  LaneQuestion question;
  JointVector seed;
  StartTable::Aim aim;
  StartTable::Place place;
  int starts_left = 0;
  int start = 0, age = 0, steps = 0;
};

class LaneSolver {
 public:
  LaneSolver(const Chain& chain, const IkOptions& options, LaneQueue* queue)
      : chain_(chain.model()),
        lanes_of_chain_(chain.lanes()),
        folded_(lanes_of_chain_.folded()),
        options_(options),
        queue_(*queue) {
    const double tolerance = options.tolerance * kPartOfTolerance;
    limits_.distance2 = std::pow(tolerance * folded_.per_metre, 2);
    limits_.turn2 = tolerance * tolerance;
    limits_.position_only = options.position_only;
    std::copy(options.locked.begin(), options.locked.end(), limits_.locked);
    any_locked_ =
        std::find(options.locked.begin(), options.locked.end(), true) != options.locked.end();
  }

  void Run() {
    for (int k = 0, count = LaneCount(); k < count && Ask(k); ++k) {
    }
    while (busy_ != 0) {
      const uint32_t arrived = StepLanes(folded_, limits_, busy_, &state_);
      for (uint32_t left = busy_; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        (arrived >> k & 1) != 0 ? Arrive(k) : GrowOlder(k);
      }
    }
  }

 private:
  // Gives a lane its next question. False when there are no more.
  bool Ask(int k) {
    Lane& lane = lanes_[k];
    lane = {};
    if (!queue_.Next(&lane.question)) {
      busy_ &= ~(1U << k);
      return false;
    }
    busy_ |= 1U << k;
    const Transform& target = lane.question.target;
    lane.seed = SeedOf(chain_, lane.question.seed, options_.locked);
    lane.aim = StartTable::At(target, options_.position_only);
    lane.starts_left = options_.max_restarts;
    if (IsOutOfReach(chain_, target, options_.tolerance))
      lane.starts_left = std::min(lane.starts_left, kRestartsWhenTooFar);
    state_.best_cost[k] = std::numeric_limits<double>::infinity();
    AimAt(k, target);
    Begin(k);
    return true;
  }

  void AimAt(int k, const Transform& tip_in_base) {
    const Transform target = chain_.joints[0].fixed.inverse() * tip_in_base;
    const Eigen::Matrix3d axes = target.rotation * chain_.last_to_tip.rotation.transpose();
    for (int i = 0; i < 9; ++i) state_.axes[i][k] = axes.data()[i];
    Eigen::Vector3d position = target.translation * folded_.per_metre;
    const double far =
        std::min(kMostReaches * chain_.reach_bound * folded_.per_metre, kMostLengths);
    const double distance = position.stableNorm();
    if (distance > far) position *= far / distance;
    for (int i = 0; i < 3; ++i) state_.position[i][k] = position[i];
  }

  void Begin(int k) {
    Lane& lane = lanes_[k];
    lane.age = 0;
    if (lane.start == 0 && !lane.question.seed.empty()) return Put(k, lane.seed.begin());
    if (lane.start < kStartsNearby && !any_locked_) {
      const float* nearby = lanes_of_chain_.starts(chain_).Next(lane.aim, &lane.place);
      if (nearby) return Put(k, nearby);
    }
    Put(k, SpreadStart(chain_, lane.seed, options_.locked, lane.start).begin());
  }

  template <class Number>
  void Put(int k, const Number* q) {
    for (int i = 0; i < chain_.n; ++i) state_.q[i][k] = q[i];
  }

  void GrowOlder(int k) {
    Lane& lane = lanes_[k];
    ++lane.steps;
    if (++lane.age < std::min(options_.max_iterations, StepsOf(lane.start)) && !IsHopeless(k))
      return;
    StartAgain(k);
  }

  bool IsHopeless(int k) const {
    const Lane& lane = lanes_[k];
    if (lane.start >= kLookedAt) return false;
    const double cost = state_.distance2[k] + state_.turn2[k];
    return (lane.age == kFirstLook && cost > kFirstCost) ||
           (lane.age == kSecondLook && cost > kSecondCost);
  }

  void StartAgain(int k) {
    Lane& lane = lanes_[k];
    if (lane.starts_left-- > 0) {
      ++lane.start;
      return Begin(k);
    }
    JointVector best(chain_.n);
    for (int i = 0; i < chain_.n; ++i) best[i] = state_.best_q[i][k];
    Answer(k, best);
  }

  void Arrive(int k) {
    JointVector q(chain_.n);
    for (int i = 0; i < chain_.n; ++i) q[i] = state_.q[i][k];
    if (!Answer(k, q)) StartAgain(k);
  }

  // Takes q to the queue and asks for the next question, unless it claims to be a solution and is
  // none.
  bool Answer(int k, JointVector q) {
    const Lane& lane = lanes_[k];
    for (int i = 0; i < chain_.n; ++i) {  // as rounded as ever, inside
      if (options_.locked[i]) q[i] = lane.seed[i];
    }
    UnwindTowards(chain_, lane.seed, options_.locked, &q);
    IkResult answer = Judged(chain_, lane.question.target, options_, q);
    if (!answer.success && lane.starts_left >= 0) return false;
    answer.iterations = lane.steps;
    answer.restarts = lane.start;
    queue_.Take(lane.question.number, answer);
    Ask(k);
    return true;
  }

  const ChainModel& chain_;
  const LaneChain& lanes_of_chain_;
  const FoldedChain& folded_;
  const IkOptions& options_;
  LaneQueue& queue_;
  LaneOptions limits_;
  bool any_locked_ = false;
  uint32_t busy_ = 0;  // a bit for each lane with a question
  LaneState state_;
  std::array<Lane, kMaxLanes> lanes_;
};

}  // namespace

void SolveLanes(const Chain& chain, const IkOptions& options, LaneQueue* queue) {
  LaneSolver(chain, options, queue).Run();
}

}  // namespace robocell
