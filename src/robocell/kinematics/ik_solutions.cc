#include "robocell/kinematics/ik_solutions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/filter_call.h"
#include "robocell/kinematics/ik_choice.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/ik_preference.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/lane_solver.h"

namespace robocell {

namespace {

// Far beyond the number that finds anything new; the results have to fit into memory.
constexpr int kMostStarts = 1'000'000;
constexpr int kStartsBetweenPolls = 16;
// Some solutions of six-joint arms are reached by one start in two hundred.
constexpr int kQuietStarts = 600, kMoreAtATime = 100;

// Makes every start a query of its own.
class EveryStart : public internal::LaneQueue {
 public:
  EveryStart(const Transform& target, const IkOptions& options, const std::function<void()>& poll)
      : target_(target), options_(options), poll_(poll) {}

  void Run(const Chain& chain, int starts) {
    answers_.resize(answers_.size() + starts);
    internal::SolveLanes(chain, options_, this);
  }

  bool Next(internal::LaneQuery* query) override {
    if (poll_ && next_ % kStartsBetweenPolls == 0) poll_();
    if (next_ >= static_cast<int>(answers_.size())) return false;
    *query = {.number = next_,
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

  const std::vector<IkResult>& answers() const { return answers_; }
  std::vector<IkResult> Solutions() {
    std::erase_if(answers_, [](const IkResult& answer) { return !answer.success; });
    return std::move(answers_);
  }

 private:
  const Transform& target_;
  const IkOptions& options_;
  const std::function<void()>& poll_;
  std::vector<IkResult> answers_;
  int next_ = 0;
};

void Filter(const IkFilter& filter, std::vector<IkResult>* solutions) {
  if (!filter) return;
  internal::FilterCall call;
  for (const IkResult& s : *solutions) call.Add(s.q);
  const std::span<const uint8_t> keep = call.Ask(filter);
  std::size_t row = 0;
  std::erase_if(*solutions, [&](const IkResult&) { return keep[row++] == 0; });
}

// Sorts by preference, and equal ones by their starts.
std::vector<IkResult> BestFirst(const ChainModel& chain, const IkOptions& options,
                                std::vector<IkResult> solutions) {
  const internal::IkPreference preference(chain, options);
  const JointVector goal =
      preference.GoalFor(internal::SeedOf(chain, options.seed, options.locked));
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < solutions.size(); ++k)
    order.emplace_back(preference.Cost(solutions[k].q, goal), k);
  std::sort(order.begin(), order.end());
  std::vector<IkResult> sorted;
  for (const auto& [cost, k] : order) sorted.push_back(solutions[k]);
  return sorted;
}

bool IsNew(const ChainModel& chain, const IkResult& found, std::span<const JointVector> known,
           double least) {
  return found.success && std::all_of(known.begin(), known.end(), [&](const JointVector& other) {
           return internal::AreApart(chain, found.q, other, least);
         });
}

// Continues beyond the requested starts until nothing new has been found for long.
void GoOn(const Chain& chain, const IkOptions& options, double separation, EveryStart* every) {
  const double least = std::max(separation, internal::kAnother);
  std::vector<JointVector> known;
  int begun = 0, newest = 0;
  while (true) {
    for (; begun < static_cast<int>(every->answers().size()); ++begun) {
      const IkResult& found = every->answers()[begun];
      if (!IsNew(chain.model(), found, known, least)) continue;
      known.push_back(found.q);
      newest = begun;
    }
    if (known.empty() || !internal::MayFindAnother(options, newest, begun, kQuietStarts)) return;
    every->Run(chain, kMoreAtATime);
  }
}

}  // namespace

std::vector<IkResult> IkSolutions(const Chain& chain, const Pose& tip_in_base,
                                  const IkOptions& options, double separation,
                                  const std::function<void()>& poll) {
  RequireIkTarget(tip_in_base, "target");
  RequireIkOptions(chain, options);
  if (!(separation > 0 && std::isfinite(separation))) {
    throw ArgumentError(
        fmt::format("inverse kinematics: separation is {}; it must be more than 0", separation));
  }
  if (options.max_restarts >= kMostStarts) {
    throw ArgumentError(fmt::format(
        "inverse kinematics: {} starts for all solutions; there may be up to {}, which is one "
        "more than max_restarts",
        int64_t{options.max_restarts} + 1, kMostStarts));
  }
  const ChainModel& model = chain.model();
  const Transform target = ToTransform(tip_in_base);
  EveryStart every(target, options, poll);
  every.Run(chain, options.max_restarts + 1);
  if (internal::LooksForAll(chain, internal::IkTask(options), options))
    GoOn(chain, options, separation, &every);
  std::vector<IkResult> solutions = every.Solutions();
  Filter(options.filter, &solutions);

  std::vector<IkResult> apart;
  for (const IkResult& s : BestFirst(model, options, std::move(solutions))) {
    const auto is_apart = [&](const IkResult& other) {
      return internal::AreApart(model, s.q, other.q, separation);
    };
    if (std::all_of(apart.begin(), apart.end(), is_apart)) apart.push_back(s);
  }
  return apart;
}

}  // namespace robocell
