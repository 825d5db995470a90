// RowQueue: the rows of a rollout, written beside it by a thread of their own, or later. Physics
// goes on while images of earlier rows are drawn and encoded; a rollout that is not kept need not
// draw anything.
//
//   RowQueue queue([&](EpisodeRow& row) { draw, encode, write }, RowQueue::Begin::kAtOnce);
//   if (!queue.Push(row, stop)) return;  // waits while too many rows are ahead
//   if (!queue.Finish(stop)) return;    // all are written, or the stop request came
//
// Rows are written one after the other, in the order of Push. What the writer throws ends the
// queue, and comes out of the next call. The destructor drops what is not yet written. All calls on
// one thread; the writer runs on the queue's.
#pragma once

#include <condition_variable>
#include <cstddef>
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

  RowQueue(std::function<void(EpisodeRow&)> write, Begin begin);
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
  void Run();
  void Start();
  void Rethrow();
  // Waits until `is_reached` or a failure. Returns false if the stop request came first.
  bool Wait(std::unique_lock<std::mutex>& lock, const StopRequest& stop,
            const std::function<bool()>& is_reached);
  size_t waiting() const { return rows_.size() + (is_writing_ ? 1 : 0); }

  std::function<void(EpisodeRow&)> write_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<EpisodeRow>> rows_;
  bool is_writing_ = false, is_over_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace robocell::internal
