#include "robocell/kinematics/lane_solver.h"

#include <array>
#include <bit>

#include "robocell/kinematics/lane_starts.h"

namespace robocell {
namespace {

struct Lane {
  LaneQuestion question;
  LaneStarts starts;
  int restarts_left = 0;
  int age = 0, steps = 0;  // of this start, of all
};

class LaneSolver {
 public:
  LaneSolver(const Chain& chain, const IkOptions& options, LaneQueue* queue)
      : work_(chain, options), queue_(*queue) {}

  void Run() {
    for (int k = 0, count = LaneCount(); k < count && Ask(k); ++k) {
    }
    while (busy_ != 0) {
      const uint32_t arrived = work_.Step(busy_);
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
    lane.starts = LaneStarts(work_, target, lane.question.seed);
    lane.restarts_left = work_.RestartsFor(target);
    work_.Aim(k, target);
    lane.starts.Begin(k, &work_);
    return true;
  }

  void GrowOlder(int k) {
    Lane& lane = lanes_[k];
    ++lane.steps;
    if (work_.IsHopeless(k, lane.starts.begun() - 1, ++lane.age)) StartAgain(k);
  }

  void StartAgain(int k) {
    Lane& lane = lanes_[k];
    if (lane.restarts_left-- == 0) {
      const JointVector best = work_.Best(k, lane.starts.seed());
      return Answer(k, Judged(work_.chain(), lane.question.target, work_.options(), best));
    }
    lane.age = 0;
    lane.starts.Begin(k, &work_);
  }

  void Arrive(int k) {
    const Lane& lane = lanes_[k];
    const JointVector q = work_.Now(k, lane.starts.seed());
    const IkResult found = Judged(work_.chain(), lane.question.target, work_.options(), q);
    found.success ? Answer(k, found) : StartAgain(k);
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
  uint32_t busy_ = 0;  // a bit for each lane with a question
  std::array<Lane, kMaxLanes> lanes_;
};

}  // namespace

void SolveLanes(const Chain& chain, const IkOptions& options, LaneQueue* queue) {
  LaneSolver(chain, options, queue).Run();
}

}  // namespace robocell
