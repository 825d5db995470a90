// RowQueue: the rows of a rollout, drawn and written beside it by threads of their own, or later.
// Physics goes on while images of earlier rows are drawn and encoded; a rollout that is not kept
// need not draw anything.
//
//   RowQueue queue({.draw = [&](EpisodeRow& row, int thread) { ... },
//                   .write = [&](EpisodeRow& row, int thread) { encode, write },
//                   .threads = 2},
//                  RowQueue::Begin::kAtOnce);
//   if (!queue.Push(row, stop)) return;  // waits while too many rows are ahead
//   if (!queue.Finish(stop)) return;    // all are written, or the stop request came
//
// Several threads draw several rows at the same time. Rows are written one after the other, in the
// order of Push, each by the thread that has drawn it. What drawing and writing throw comes out of
// the next call once all earlier rows are written, and ends the queue. The destructor drops what is
// not yet written. All calls on one thread.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "robocell/base/stop.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/state_drawer.h"

namespace robocell::internal {

// A row as it happened: the state before the action, and what came of it.
struct EpisodeRow {
  std::vector<double> observed, commanded;
  std::vector<double> intended;  // of a run with noise
  int phase = 0;
  RowOutcome outcome;
  std::vector<double> tick_times, ctrl;  // of its control ticks
  DrawnState state;                      // what its images show
  bool is_drawn = false;                 // its images are those that the cameras have drawn last
};

class RowQueue {
 public:
  enum class Begin { kAtOnce, kAtFinish };
  // Bounds the rows that wait for the writer. Each takes kilobytes.
  static constexpr size_t kMostAhead = 256;

  // The work on a row; `thread`: 0 to threads - 1, and what it uses is its own while it draws and
  // writes the row.
  struct Work {
    std::function<void(EpisodeRow&, int thread)> draw = {};  // none if empty
    std::function<void(EpisodeRow&, int thread)> write;
    int threads = 1;
  };

  RowQueue(Work work, Begin begin);
  ~RowQueue();
  RowQueue(const RowQueue&) = delete;
  RowQueue& operator=(const RowQueue&) = delete;

  // Returns false, without the row, if the stop request came while it waited.
  bool Push(std::shared_ptr<EpisodeRow> row, const StopRequest& stop);
  // Waits until all rows are written, and begins to if that was to come later. Rows that are pushed
  // afterwards are written at once. Returns false if the stop request came first.
  bool Finish(const StopRequest& stop);
  // Throws what the writer has thrown so far. Does not wait.
  void ThrowFailure();

 private:
  void Run(int thread);
  // Draws and writes a row in its turn, with the mutex unlocked meanwhile. Returns false if the
  // queue is over.
  bool Process(EpisodeRow& row, int64_t turn, int thread, std::unique_lock<std::mutex>& lock);
  void Start();
  void Rethrow();
  // Waits until `is_reached` or a failure. Returns false if the stop request came first.
  bool Wait(std::unique_lock<std::mutex>& lock, const StopRequest& stop,
            const std::function<bool()>& is_reached);
  size_t waiting() const { return rows_.size() + static_cast<size_t>(taken_ - written_); }
  bool is_over() const { return is_destroyed_ || failure_; }

  Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<EpisodeRow>> rows_;
  int64_t taken_ = 0, written_ = 0;  // rows that threads have begun with, and are done with
  bool is_destroyed_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

}  // namespace robocell::internal
