#include "robocell/kinematics/ik_batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/ik_choice.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/lane_solver.h"
#include "robocell/kinematics/on_threads.h"

namespace robocell {

namespace {

// Number of queries that a thread takes at a time: neighbours, so that threads hardly ever write to
// the same cache line, and few, so that none waits long for the last.
constexpr int kTakenTogether = 64;

// Number of queries whose solutions are chosen together.
constexpr int kChosenTogether = 64;

const std::function<void()> kNoPoll;

// The layout of the seeds for B queries about n joints.
enum class Seeds { kNone, kOne, kEach };

Seeds LayoutOf(const Chain& chain, std::size_t queries, std::size_t values) {
  const std::size_t n = chain.n_joints();
  if (values == 0) return Seeds::kNone;
  if (values == n) return Seeds::kOne;
  if (values == n * queries) return Seeds::kEach;
  throw ArgumentError(
      fmt::format("batched inverse kinematics of {}: expected {} (one seed) or {} ({} of "
                  "{}), got {}",
                  chain.description(), Counted(static_cast<int64_t>(n), "seed value"), n * queries,
                  Counted(static_cast<int64_t>(queries), "seed"),
                  Counted(static_cast<int64_t>(n), "joint"), values));
}

class Batch {
 public:
  Batch(const Chain& chain, const IkTargets& targets, std::span<const double> seeds,
        const IkBatchOptions& options, IkBatchResult* result)
      : chain_(chain),
        targets_(targets),
        seeds_(seeds),
        layout_(LayoutOf(chain, targets.size(), seeds.size())),
        options_(options),
        out_(*result) {
    RequireValid();
    Resize();
  }

  void Run() {
    const bool chosen = internal::IsChosen(options_.ik);
    // More threads would find nothing to take.
    const int shares = chosen ? std::min(out_.size, kChosenTogether)
                              : (out_.size + kTakenTogether - 1) / kTakenTogether;
    const int threads = std::clamp(options_.threads, 1, std::max(1, shares));
    if (threads > 1) chain_.lanes().starts(chain_.model());  // throws here, not in a thread
    if (chosen) return ChooseAll(threads);
    internal::OnThreads(threads, [&](int t) { SolveShare(t == 0 ? options_.poll : kNoPoll); });
  }

 private:
  std::span<const double> SeedOf(int b) const {
    if (layout_ == Seeds::kNone) return {};
    const std::size_t n = chain_.n_joints();
    return seeds_.subspan(layout_ == Seeds::kEach ? b * n : 0, n);
  }

  void RequireValid() const {
    if (!options_.ik.seed.empty()) {
      throw ArgumentError(
          "batched inverse kinematics: options.ik.seed is set; pass seeds as the third argument");
    }
    if (options_.threads < 1) {
      throw ArgumentError(fmt::format(
          "batched inverse kinematics: threads is {}; it must be 1 or more", options_.threads));
    }
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      if (std::isfinite(seeds_[i])) continue;
      throw ArgumentError(fmt::format("batched inverse kinematics: seeds[{}][{}] is {}",
                                      i / chain_.n_joints(), i % chain_.n_joints(), seeds_[i]));
    }
    IkOptions first = options_.ik;
    first.seed = JointVector(SeedOf(0));
    // Without targets no query lacks a seed.
    if (targets_.empty() && first.seed.empty()) first.seed = JointVector(chain_.n_joints());
    RequireIkOptions(chain_, first);
    for (std::size_t b = 0; b < targets_.size(); ++b) {
      if (!targets_.is_finite(b)) RefuseIkTarget(fmt::format("targets[{}]", b));
    }
  }

  void Resize() {
    const std::size_t size = targets_.size();
    out_.size = static_cast<int>(size);
    out_.n_joints = chain_.n_joints();
    out_.q.resize(size * out_.n_joints);
    out_.success.resize(size);
    out_.position_error.resize(size);
    out_.rotation_error.resize(size);
    out_.iterations.resize(size);
  }

  // Ends the helpers when an exception leaves the caller's thread.
  struct Ending {
    std::atomic<bool>& flag;
    int before = std::uncaught_exceptions();
    ~Ending() {
      if (std::uncaught_exceptions() > before) flag = true;
    }
  };

  // The work of one thread: some queries, and more when these are done.
  class Share : public internal::LaneQueue {
   public:
    Share(Batch* batch, const std::function<void()>& poll) : batch_(*batch), poll_(poll) {}

    bool Next(internal::LaneQuery* query) override {
      PollNowAndThen();
      if (next_ == end_) TakeMore();
      if (next_ == end_ || batch_.ended_) return false;
      *query = {next_, batch_.targets_[next_], batch_.SeedOf(next_)};
      ++next_;
      return true;
    }
    void Take(int number, const IkResult& answer) override { batch_.Keep(number, answer); }
    bool GoesOn() override {
      PollNowAndThen();
      return !batch_.ended_;
    }

   private:
    void PollNowAndThen() {
      if (poll_ && ++polls_ % internal::kPollEvery == 1) poll_();
    }
    void TakeMore() {
      const int64_t first = batch_.taken_.fetch_add(kTakenTogether, std::memory_order_relaxed);
      const int64_t size = batch_.out_.size;
      next_ = static_cast<int>(std::min(first, size));
      end_ = static_cast<int>(std::min(first + kTakenTogether, size));
    }

    Batch& batch_;
    int next_ = 0, end_ = 0;
    unsigned polls_ = 0;
    const std::function<void()>& poll_;
  };

  void SolveShare(const std::function<void()>& poll) {
    const Ending ending{ended_};
    Share share(this, poll);
    internal::SolveLanes(chain_, options_.ik, &share);
  }

  void ChooseAll(int threads) {
    std::vector<internal::LaneQuery> queries;
    std::vector<internal::IkChoice::Search> searches(std::size_t{kChosenTogether} *
                                                     internal::IkChoice::kSearches);
    std::vector<IkResult> answers(kChosenTogether);
    for (int first = 0; first < out_.size; first += kChosenTogether) {
      const int count = std::min(kChosenTogether, out_.size - first);
      queries.clear();
      for (int b = first; b < first + count; ++b)
        queries.push_back({.target = targets_[b], .seed = SeedOf(b)});
      internal::IkChoice choice(
          chain_, options_.ik, queries,
          std::span(searches).first(std::size_t(count) * internal::IkChoice::kSearches), answers);
      do {
        if (options_.poll) options_.poll();
        internal::OnThreads(threads, [&](int t) {
          const Ending ending{ended_};
          choice.Run(t, threads, ended_, t == 0 ? options_.poll : kNoPoll);
        });
      } while (choice.Choose());
      for (int k = 0; k < count; ++k) Keep(first + k, answers[k]);
    }
  }

  void Keep(int b, const IkResult& found) {
    std::copy(found.q.begin(), found.q.end(), out_.q.begin() + std::ptrdiff_t(b) * out_.n_joints);
    out_.success[b] = found.success;
    out_.position_error[b] = found.position_error;
    out_.rotation_error[b] = found.rotation_error;
    out_.iterations[b] = found.iterations;
  }

  const Chain& chain_;
  const IkTargets& targets_;
  std::span<const double> seeds_;
  Seeds layout_;
  const IkBatchOptions& options_;
  IkBatchResult& out_;
  std::atomic<int64_t> taken_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace

int IkBatchResult::solved() const {
  return static_cast<int>(std::count(success.begin(), success.end(), uint8_t{1}));
}

void IkBatch(const Chain& chain, const IkTargets& tips_in_base, std::span<const double> seeds,
             const IkBatchOptions& options, IkBatchResult* result) {
  Batch(chain, tips_in_base, seeds, options, result).Run();
}

IkBatchResult IkBatch(const Chain& chain, const IkTargets& tips_in_base,
                      std::span<const double> seeds, const IkBatchOptions& options) {
  IkBatchResult result;
  IkBatch(chain, tips_in_base, seeds, options, &result);
  return result;
}

}  // namespace robocell
