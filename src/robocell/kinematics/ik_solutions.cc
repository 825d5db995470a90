#include "robocell/kinematics/ik_solutions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/ik_preference.h"
#include "robocell/kinematics/lane_solver.h"

namespace robocell {
namespace {

// Every start is a question of its own.
class EveryStart : public LaneQueue {
 public:
  EveryStart(const Transform& target, const IkOptions& options)
      : target_(target), options_(options), answers_(std::size_t(options.max_restarts) + 1) {}

  bool Next(LaneQuestion* question) override {
    if (next_ >= static_cast<int>(answers_.size())) return false;
    *question = {.number = next_,
                 .target = target_,
                 .seed = options_.seed,
                 .first = next_,
                 .stride = 1,
                 .most = 1};
    ++next_;
    return true;
  }
  void Take(int number, const IkResult& answer) override {
    answers_[number] = answer;
    answers_[number].restarts = number;
  }

  std::vector<IkResult> Solutions() {
    std::erase_if(answers_, [](const IkResult& answer) { return !answer.success; });
    return std::move(answers_);
  }

 private:
  const Transform& target_;
  const IkOptions& options_;
  std::vector<IkResult> answers_;
  int next_ = 0;
};

void Filter(const IkFilter& filter, std::vector<IkResult>* solutions) {
  if (!filter || solutions->empty()) return;
  std::vector<double> rows;
  for (const IkResult& s : *solutions) rows.insert(rows.end(), s.q.begin(), s.q.end());
  std::vector<uint8_t> keep(solutions->size());
  filter(rows, static_cast<int>(solutions->size()), keep);
  std::size_t row = 0;
  std::erase_if(*solutions, [&](const IkResult&) { return keep[row++] == 0; });
}

bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least) {
  for (int i = 0; i < chain.n; ++i) {
    const double lengths = chain.joints[i].slide ? chain.length : 1;
    if (std::abs(a[i] - b[i]) > least * lengths) return true;
  }
  return false;
}

}  // namespace

std::vector<IkResult> IkSolutions(const Chain& chain, const Pose& tip_in_base,
                                  const IkOptions& options, double separation) {
  CheckIkTarget(tip_in_base, "target");
  CheckIkOptions(chain, options);
  if (!(separation > 0 && std::isfinite(separation))) {
    throw ArgumentError(
        fmt::format("inverse kinematics: separation is {}; it must be more than 0", separation));
  }
  const ChainModel& model = chain.model();
  const Transform target = ToTransform(tip_in_base);
  EveryStart every(target, options);
  SolveLanes(chain, options, &every);
  std::vector<IkResult> solutions = every.Solutions();
  Filter(options.filter, &solutions);

  const IkPreference preference(model, options);
  const JointVector goal = preference.GoalFor(SeedOf(model, options.seed, options.locked));
  std::stable_sort(solutions.begin(), solutions.end(), [&](const IkResult& a, const IkResult& b) {
    return preference.Cost(a.q, goal) < preference.Cost(b.q, goal);
  });
  std::vector<IkResult> apart;
  for (const IkResult& s : solutions) {
    const auto is_apart = [&](const IkResult& other) {
      return AreApart(model, s.q, other.q, separation);
    };
    if (std::all_of(apart.begin(), apart.end(), is_apart)) apart.push_back(s);
  }
  return apart;
}

}  // namespace robocell
