#include "robocell/kinematics/lane_solver.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/lane_starts.h"

namespace robocell::internal {
namespace {

// Steps in which redundant joints go to their goal at most, and then at most to be at the target
// again. Where the goal lies across the way that is open, the last part takes longest: after 20
// steps one in ten is still on its way.
constexpr int kStepsToGoal = 40, kStepsBack = 12;
// Number of steps between two computations of the goal, each of which costs more than a step.
constexpr int kStepsAGoal = 8;
// Joints that move less in the first step to it rest, rad or lengths of the chain.
constexpr double kRest = 2e-4;

struct Lane {
  LaneQuestion question;
  LaneStarts starts;
  int restarts_left = 0;
  bool goes_on = false;    // with more restarts than are allowed at first
  int age = 0, steps = 0;  // of this start, of all
  bool settles = false;    // has arrived; its redundant joints are on their way
  JointVector before;      // the last step of that
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
  // Gives a lane its next query. Returns false when there are no more.
  bool Ask(int k) {
    Lane& lane = lanes_[k];
    lane = {};
    if (!queue_.Next(&lane.question)) {
      busy_ &= ~(1U << k);
      return false;
    }
    busy_ |= 1U << k;
    const Transform& target = lane.question.target;
    lane.starts =
        LaneStarts(work_, target, lane.question.seed, lane.question.first, lane.question.stride);
    const int most = lane.question.most;
    lane.restarts_left = most < 0 ? work_.RestartsFor(target) : most - 1;
    work_.Aim(k, target);
    lane.starts.Begin(k, &work_);
    return true;
  }

  void GrowOlder(int k) {
    Lane& lane = lanes_[k];
    ++lane.steps;
    const int failed = lane.question.patient ? lane.starts.number() : lane.starts.begun() - 1;
    if (work_.IsHopeless(k, failed, ++lane.age)) StartAgain(k);
  }

  void StartAgain(int k) {
    Lane& lane = lanes_[k];
    if (lane.restarts_left == 0) GoOnWhereNear(k);
    if (lane.restarts_left-- == 0 || !queue_.GoesOn()) {
      const JointVector best = work_.Best(k, lane.starts.seed());
      return Answer(k, work_.Judge(lane.question.target, best));
    }
    lane.age = 0;
    lane.starts.Begin(k, &work_);
  }

  void GoOnWhereNear(int k) {
    Lane& lane = lanes_[k];
    if (lane.goes_on || lane.question.most >= 0) return;
    lane.goes_on = true;
    lane.restarts_left = work_.MoreRestartsFor(lane.question.target, work_.best_cost(k));
  }

  void Arrive(int k) {
    const Lane& lane = lanes_[k];
    const JointVector q = work_.Now(k, lane.starts.seed());
    const IkResult found = work_.Judge(lane.question.target, q);
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
    const IkResult moved = work_.Judge(lane.question.target, q);
    IkResult before = unmoved_[k];
    before.iterations = lane.steps;
    before.restarts = lane.starts.begun() - 1;
    queue_.TakeUnmoved(lane.question.number, before);
    Answer(k, moved.success ? moved : unmoved_[k]);
  }

  void Answer(int k, IkResult answer) {
    const Lane& lane = lanes_[k];
    answer.iterations = lane.steps;
    answer.restarts = lane.starts.begun() - 1;
    queue_.Take(lane.question.number, answer);
    Ask(k);
  }

  LaneWork work_;
  LaneQueue& queue_;
  uint32_t busy_ = 0;  // a bit for each lane with a query
  std::array<Lane, kMaxLanes> lanes_;
  std::array<IkResult, kMaxLanes> unmoved_;  // of the lanes that settle
};

}  // namespace

void SolveLanes(const Chain& chain, const IkOptions& options, LaneQueue* queue) {
  LaneSolver(chain, options, queue).Run();
}

}  // namespace robocell::internal
