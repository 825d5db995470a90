#include "robocell/kinematics/lane_solver.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/lane_starts.h"

namespace robocell::internal {
namespace {

// The largest number of steps in which redundant joints go to their goal, and then return to the
// target. If the goal lies across the free direction, the last part takes longest: after 20 steps
// one in ten still moves.
constexpr int kStepsToGoal = 40, kStepsBack = 12;
// Number of steps between two computations of the goal, each of which costs more than a step.
constexpr int kStepsAGoal = 8;
// Joints that move less in the first step to the goal rest, rad or lengths of the chain.
constexpr double kRest = 2e-4;

struct Lane {
  LaneQuery query;
  LaneStarts starts;
  int restarts_left = 0;
  bool goes_on = false;    // true with more restarts than first allowed
  int age = 0, steps = 0;  // steps of this start, steps of all
  bool settles = false;    // has arrived; its redundant joints still move
  JointVector before;      // the last step before
};

double FarthestMove(const ChainModel& chain, const JointVector& from, const JointVector& to) {
  double most = 0;
  for (int i = 0; i < chain.n; ++i)
    most = std::max(most, std::abs(to[i] - from[i]) / UnitOf(chain, i));
  return most;
}

class LaneSolver {
 public:
  LaneSolver(const Chain& chain, const IkOptions& options, LaneQueue* queue)
      : work_(chain, options), queue_(*queue) {
    work_.Clear(0, LaneCount());
  }

  void Run() {
    for (int k = 0, count = LaneCount(); k < count && Ask(k); ++k) {
    }
    while (busy_ != 0) {
      const uint32_t arrived = work_.Step(busy_);
      for (uint32_t left = busy_; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        const bool there = (arrived >> k & 1) != 0;
        if (lanes_[k].settles) {
          Settle(k, there);
        } else {
          there ? Arrive(k) : GrowOlder(k);
        }
      }
    }
  }

 private:
  // Gives a lane its next query. Returns false if there is none.
  bool Ask(int k) {
    Lane& lane = lanes_[k];
    lane = {};
    if (!queue_.Next(&lane.query)) {
      busy_ &= ~(1U << k);
      return false;
    }
    busy_ |= 1U << k;
    const Transform& target = lane.query.target;
    lane.starts = LaneStarts(work_, target, lane.query.seed, lane.query.first, lane.query.stride);
    const int most = lane.query.most;
    lane.restarts_left = most < 0 ? work_.RestartsFor(target) : most - 1;
    work_.Aim(k, target);
    lane.starts.Begin(k, &work_);
    return true;
  }

  void GrowOlder(int k) {
    Lane& lane = lanes_[k];
    ++lane.steps;
    const int failed = lane.query.patient ? lane.starts.number() : lane.starts.begun() - 1;
    if (work_.IsHopeless(k, failed, ++lane.age)) StartAgain(k);
  }

  void StartAgain(int k) {
    Lane& lane = lanes_[k];
    if (lane.restarts_left == 0) GoOnWhereNear(k);
    if (lane.restarts_left-- == 0 || !queue_.GoesOn()) {
      const JointVector best = work_.Best(k, lane.starts.seed());
      return Answer(k, work_.Judge(lane.query.target, best));
    }
    lane.age = 0;
    lane.starts.Begin(k, &work_);
  }

  void GoOnWhereNear(int k) {
    Lane& lane = lanes_[k];
    if (lane.goes_on || lane.query.most >= 0) return;
    lane.goes_on = true;
    lane.restarts_left = work_.MoreRestartsFor(lane.query.target, work_.best_cost(k));
  }

  void Arrive(int k) {
    const Lane& lane = lanes_[k];
    const JointVector q = work_.Now(k, lane.starts.seed());
    const IkResult found = work_.Judge(lane.query.target, q);
    if (!found.success) return StartAgain(k);
    work_.settles() ? BeginToSettle(k, found) : Answer(k, found);
  }

  void BeginToSettle(int k, const IkResult& found) {
    Lane& lane = lanes_[k];
    unmoved_[k] = found;
    lane.settles = true;
    lane.before = found.q;
    lane.age = 0;
    work_.Put(k, found.q.data());
    Pull(k, found.q);
  }

  void Pull(int k, const JointVector& q) {
    work_.Pull(k, work_.preference().GoalFrom(q, lanes_[k].starts.seed()));
  }

  void Settle(int k, bool there) {
    Lane& lane = lanes_[k];
    ++lane.steps;
    ++lane.age;
    const JointVector q = work_.Now(k, lane.starts.seed());
    const bool at_rest =
        lane.age % kStepsAGoal == 1 && FarthestMove(work_.chain(), lane.before, q) < kRest;
    if (at_rest && lane.age < kStepsToGoal) lane.age = kStepsToGoal;
    if (lane.age < kStepsToGoal) {
      lane.before = q;
      work_.Put(k, q.data());  // the same turn as the goal's
      if (lane.age % kStepsAGoal == 0) Pull(k, q);
      return;
    }
    if (lane.age == kStepsToGoal) return work_.LetGo(k);
    if (!there && lane.age < kStepsToGoal + kStepsBack) return;
    const IkResult moved = work_.Judge(lane.query.target, q);
    IkResult before = unmoved_[k];
    before.iterations = lane.steps;
    before.restarts = lane.starts.begun() - 1;
    queue_.TakeUnmoved(lane.query.number, before);
    Answer(k, moved.success ? moved : unmoved_[k]);
  }

  void Answer(int k, IkResult answer) {
    const Lane& lane = lanes_[k];
    answer.iterations = lane.steps;
    answer.restarts = lane.starts.begun() - 1;
    queue_.Take(lane.query.number, answer);
    Ask(k);
  }

  LaneWork work_;
  LaneQueue& queue_;
  uint32_t busy_ = 0;  // a bit for each lane with a query
  std::array<Lane, kMaxLanes> lanes_;
  std::array<IkResult, kMaxLanes> unmoved_;  // results of the lanes that settle
};

// If the seed is farther from the target than this (squared error), or has not arrived after this
// many steps, other starts join it.
constexpr double kNearSeed = 0.25;
constexpr int kStepsAlone = 8;

class LaneSearch {
 public:
  LaneSearch(const Chain& chain, const Transform& target, const IkOptions& options,
             const std::function<void()>& poll)
      : work_(chain, options),
        target_(target),
        poll_(poll),
        starts_(work_, target, options.seed),
        seed_searches_(!options.seed.empty()) {}

  IkResult Run() {
    Begin(0);
    if (!seed_searches_) Join();
    Search();
    if (!answer_.success) GoOnWhereNear();
    if (answer_.success) {
      answer_.restarts = winner_;
    } else {
      answer_ = work_.Judge(target_, work_.Best(BestLane(), starts_.seed()));
      answer_.restarts = starts_.begun() - 1;
    }
    answer_.iterations = steps_ - (only_measured_ ? 1 : 0);
    return answer_;
  }

 private:
  void Search() {
    while (busy_ != 0 && !Step()) {
      if (!joined_ && (steps_ == kStepsAlone || work_.cost(0) > kNearSeed)) Join();
    }
  }

  // Called when all starts have failed.
  void GoOnWhereNear() {
    starts_left_ = work_.MoreRestartsFor(target_, work_.best_cost(BestLane()));
    for (int lane = 0; lane < LanesOfOneQuery(); ++lane) Begin(lane);
    Search();
  }

  // Begins starts in all idle lanes. All lanes cost as much as two.
  void Join() {
    joined_ = true;
    starts_left_ += work_.RestartsFor(target_);
    const int count = LanesOfOneQuery();
    work_.Clear(1, count);
    if (starts_left_ > 0) starts_.Foresee(count, work_);
    for (int lane = 0; lane < count; ++lane) {
      if ((busy_ >> lane & 1) == 0) Begin(lane);
    }
  }

  void Begin(int lane) {
    busy_ &= ~(1U << lane);
    if (starts_left_ == 0) return;
    --starts_left_;
    busy_ |= 1U << lane;
    if (!IsAimed(lane)) work_.Aim(lane, target_);
    aimed_ |= 1U << lane;
    tried_ &= ~(1U << lane);
    age_[lane] = 0;
    number_[lane] = starts_.begun();
    starts_.Begin(lane, &work_);
  }

  // Returns true if a solution was found that no other can replace.
  bool Step() {
    ++steps_;
    const uint32_t arrived = work_.Step(busy_);
    for (uint32_t left = busy_; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const bool there = (arrived >> lane & 1) != 0;
      if (there || IsWorthATry(lane)) TryAnswer(lane, there);
    }
    if (answer_.success && winner_ == 0) return true;
    for (uint32_t left = busy_; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const bool failed = (arrived >> lane & 1) != 0;
      if (failed || work_.IsHopeless(lane, number_[lane], ++age_[lane])) GiveUp(lane);
    }
    if (!answer_.success) return false;
    busy_ &= 1U;  // the seed's search continues and takes precedence
    return !seed_searches_;
  }

  bool IsAimed(int lane) const { return (aimed_ >> lane & 1) != 0; }

  // Returns true if the lane has most likely arrived with this step, so that it is judged at once.
  bool IsWorthATry(int lane) const {
    return (tried_ >> lane & 1) == 0 && age_[lane] < work_.options().max_iterations &&
           work_.IsLikelyThere(lane);
  }

  void TryAnswer(int lane, bool only_measured) {
    tried_ |= 1U << lane;
    if (answer_.success && number_[lane] > winner_) return;
    const IkResult found = work_.Judge(target_, work_.Now(lane, starts_.seed()));
    if (!found.success) return;
    answer_ = found;
    winner_ = number_[lane];
    only_measured_ = only_measured;
  }

  void GiveUp(int lane) {
    if (number_[lane] == 0) seed_searches_ = false;
    if (answer_.success) return;
    if (poll_ && starts_.begun() % static_cast<int>(kPollEvery) == 0) poll_();
    if (joined_) return Begin(lane);
    busy_ = 0;
    Join();
  }

  int BestLane() const {
    int best = 0;
    for (int lane = 1; lane < kMaxLanes; ++lane) {
      if (IsAimed(lane) && work_.best_cost(lane) < work_.best_cost(best)) best = lane;
    }
    return best;
  }

  LaneWork work_;
  const Transform& target_;
  const std::function<void()>& poll_;
  LaneStarts starts_;
  int64_t starts_left_ = 1;  // valid until others join
  int steps_ = 0;
  bool seed_searches_;  // not given up
  bool joined_ = false;
  uint32_t busy_ = 0, aimed_ = 0, tried_ = 0;  // bits of lanes
  std::array<int, kMaxLanes> age_, number_;    // values of busy lanes
  IkResult answer_;
  int winner_ = 0;
  bool only_measured_ = true;  // the last step of the result
};

}  // namespace

void SolveLanes(const Chain& chain, const IkOptions& options, LaneQueue* queue) {
  LaneSolver(chain, options, queue).Run();
}

IkResult SearchInLanes(const Chain& chain, const Transform& tip_in_base, const IkOptions& options,
                       const std::function<void()>& poll) {
  return LaneSearch(chain, tip_in_base, options, poll).Run();
}

}  // namespace robocell::internal
