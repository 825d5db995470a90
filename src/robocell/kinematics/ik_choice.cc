#include "robocell/kinematics/ik_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "robocell/kinematics/ik_parts.h"

namespace robocell::internal {
namespace {

constexpr int kMostStartsMore = 2000;

// After this many starts without an improvement the best is most likely known.
constexpr int kNothingBetter = 256;

}  // namespace

bool LooksForAll(const Chain& chain, const IkTask& task, const IkOptions& options) {
  return options.max_restarts + 1 >= kFewStarts &&
         !task.leaves_joints(chain.n_joints(), options.locked);
}

bool MayFindAnother(const IkOptions& options, int newest, int begun, int quiet) {
  return begun - newest <= quiet && begun - kMostStartsMore <= options.max_restarts;
}

bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least) {
  for (int i = 0; i < chain.n; ++i) {
    const double displacement = a[i] - b[i];
    const double apart =
        chain.joints[i].slide ? displacement / chain.length : std::remainder(displacement, kTurn);
    if (std::abs(apart) > least) return true;
  }
  return false;
}

bool IsChosen(const IkOptions& options) {
  return options.prefer != IkPrefer::kFirst || options.filter != nullptr;
}

// One thread's share of the open searches: those of every stride-th query.
class IkChoice::Queue : public LaneQueue {
 public:
  Queue(IkChoice* choice, int first, int stride, const std::atomic<bool>& ended,
        const std::function<void()>& poll)
      : choice_(*choice), query_(first), stride_(stride), ended_(ended), poll_(poll) {}

  bool Next(LaneQuery* query) override {
    const int count = static_cast<int>(choice_.queries_.size());
    for (; query_ < count && !ended_; query_ += stride_, index_ = 0) {
      for (; index_ < kSearches; ++index_) {
        const int number = query_ * kSearches + index_;
        const Search& search = choice_.searches_[number];
        if (!search.open) continue;
        *query = choice_.queries_[query_];
        query->number = number;
        query->first = search.next_start;
        query->stride = kSearches;
        query->most = search.starts_left;
        query->patient = search.patient;
        ++index_;
        return true;
      }
    }
    return false;
  }
  bool GoesOn() override {
    if (poll_ && ++starts_ % kPollEvery == 0) poll_();
    return !ended_;
  }
  void TakeUnmoved(int number, const IkResult& answer) override {
    Search& search = choice_.searches_[number];
    search.unmoved = answer;
    search.unmoved_too = true;
  }
  void Take(int number, const IkResult& answer) override {
    Search& search = choice_.searches_[number];
    search.found = answer;
    const int used = answer.restarts + 1;
    search.began = search.next_start + kSearches * answer.restarts;
    search.next_start += kSearches * used;
    search.starts_left -= used;
  }

 private:
  IkChoice& choice_;
  int query_, stride_, index_ = 0;
  const std::atomic<bool>& ended_;
  const std::function<void()>& poll_;
  unsigned starts_ = 0;
};

IkChoice::IkChoice(const Chain& chain, const IkOptions& options, std::span<const LaneQuery> queries,
                   std::span<Search> searches, std::span<IkResult> answers)
    : chain_(chain),
      options_(options),
      task_(options),
      preference_(chain.model(), options),
      compares_all_(preference_.any() && LooksForAll(chain, task_, options)),
      queries_(queries),
      searches_(searches),
      answers_(answers) {
  for (std::size_t k = 0; k < queries.size(); ++k) {
    Begin(static_cast<int>(k), /*patient=*/false);
    answers_[k] = {.position_error = std::numeric_limits<double>::infinity()};
    // A query with a filter but without a preference is usually solved at once.
    Open(static_cast<int>(k), preference_.any() ? kSearches : 1);
  }
}

int IkChoice::StartsFor(const LaneQuery& query) const {
  const int restarts = RestartsFor(chain_.model(), task_, options_, query.target);
  return std::min(restarts, std::numeric_limits<int>::max() - kSearches) + 1;
}

int IkChoice::MoreStartsFor(int query) const {
  const IkResult& best = answers_[query];
  const bool is_refused = best.position_error <= options_.tolerance &&
                          (task_.position_only || best.rotation_error <= options_.tolerance);
  if (is_refused) return 0;  // rejected by the filter
  return MoreRestartsFor(chain_.model(), task_, options_, queries_[query].target, Miss(best));
}

void IkChoice::Begin(int query, bool patient) {
  const int64_t starts = int64_t{StartsFor(queries_[query])} + (patient ? MoreStartsFor(query) : 0);
  for (int index = 0; index < kSearches; ++index) {
    searches_[query * kSearches + index] = {
        .next_start = index,
        .starts_left = static_cast<int>((starts - index + kSearches - 1) / kSearches),
        .patient = patient};
  }
}

bool IkChoice::MayBeginAgain(int query) const {
  const std::span<const Search> searches =
      searches_.subspan(std::size_t(query) * kSearches, kSearches);
  const auto is_used_up = [](const Search& search) { return search.starts_left <= 0; };
  return !searches.front().patient && std::all_of(searches.begin(), searches.end(), is_used_up) &&
         StartsFor(queries_[query]) >= kFewStarts;
}

void IkChoice::Open(int query, int searches) {
  for (int index = 0; index < searches; ++index) {
    Search& search = searches_[query * kSearches + index];
    search.open = search.starts_left > 0;
    search.unmoved_too = false;
  }
}

void IkChoice::Run(int first, int stride, const std::atomic<bool>& ended,
                   const std::function<void()>& poll) {
  Queue queue(this, first, stride, ended, poll);
  SolveLanes(chain_, options_, &queue);
}

bool IkChoice::GoesOn(int query) const {
  const Search& first = searches_[std::size_t(query) * kSearches];
  return compares_all_ &&
         MayFindAnother(options_, answers_[query].restarts, first.next_start, kNothingBetter);
}

void IkChoice::LookFurther(int query) {
  for (Search& search : searches_.subspan(std::size_t(query) * kSearches, kSearches))
    search.starts_left = 1;
}

JointVector IkChoice::GoalOf(int query) const {
  return preference_.GoalFor(SeedOf(chain_.model(), queries_[query].seed, options_.locked));
}

double IkChoice::CostOf(int query) const {
  const IkResult& answer = answers_[query];
  if (!answer.success) return std::numeric_limits<double>::infinity();
  return preference_.Cost(answer.q, GoalOf(query));
}

template <class Use>
void IkChoice::ForBetter(Search& search, const JointVector& goal, double least, const Use& use) {
  if (!search.open || !search.found.success) return;
  const auto look = [&](const IkResult& result) {
    const double cost =
        preference_.any() ? preference_.Cost(result.q, goal) : static_cast<double>(search.began);
    if (cost < least) use(result, cost);
  };
  look(search.found);
  if (search.unmoved_too) look(search.unmoved);
}

std::span<const uint8_t> IkChoice::Filter() {
  if (!options_.filter) return {};
  for (int k = 0; k < static_cast<int>(queries_.size()); ++k) {
    const JointVector goal = GoalOf(k);
    const double least = CostOf(k);
    for (Search& search : searches_.subspan(std::size_t(k) * kSearches, kSearches)) {
      ForBetter(search, goal, least,
                [&](const IkResult& result, double) { filtered_.Add(result.q); });
    }
  }
  return filtered_.Ask(options_.filter);
}

// Returns the error of an approach; if any rotation is accepted, the tip's rotation does not count.
double IkChoice::Miss(const IkResult& result) const {
  const double lengths = result.position_error / chain_.model().length;
  const double turn = task_.position_only ? 0 : result.rotation_error;
  return lengths * lengths + turn * turn;
}

void IkChoice::ChooseFor(int query, std::span<const uint8_t> keep, std::size_t* row) {
  IkResult& answer = answers_[query];
  const JointVector goal = GoalOf(query);
  const double before = CostOf(query);
  double least = before;
  IkResult best = answer;
  int steps = answer.iterations;
  const std::span<Search> searches = searches_.subspan(std::size_t(query) * kSearches, kSearches);
  for (Search& search : searches) {
    if (!search.open) continue;
    steps += search.found.iterations;
    const auto take = [&](const IkResult& result, bool success) {
      best = result;
      best.success = success;
      best.restarts = search.began;
    };
    // The best approach, in case there is no solution.
    if (!best.success && Miss(search.found) < Miss(best)) take(search.found, false);
    ForBetter(search, goal, before, [&](const IkResult& result, double cost) {
      const bool kept = keep.empty() || keep[*row] != 0;
      ++*row;
      if (!kept) return;
      // Rounding makes a repeated solution slightly better or worse each time.
      const bool again = best.success && !AreApart(chain_.model(), result.q, best.q, kAnother);
      const int first = again ? std::min(best.restarts, search.began) : search.began;
      if (cost < least) {
        least = cost;
        take(result, true);
        best.restarts = first;
      } else if (again) {
        best.restarts = first;
      }
    });
  }
  answer = best;
  answer.iterations = steps;
}

bool IkChoice::Choose() {
  const std::span<const uint8_t> keep = Filter();
  bool open = false;
  std::size_t row = 0;
  for (int k = 0; k < static_cast<int>(queries_.size()); ++k) {
    const std::span<Search> searches = searches_.subspan(std::size_t(k) * kSearches, kSearches);
    const auto is_open = [](const Search& search) { return search.open; };
    if (std::none_of(searches.begin(), searches.end(), is_open)) continue;
    ChooseFor(k, keep, &row);
    for (Search& search : searches) search.open = false;
    if (answers_[k].success) {
      if (!GoesOn(k)) continue;
      LookFurther(k);
    } else if (MayBeginAgain(k)) {
      Begin(k, /*patient=*/true);
    }
    Open(k, kSearches);
    open = open || std::any_of(searches.begin(), searches.end(), is_open);
  }
  return open;
}

}  // namespace robocell::internal
