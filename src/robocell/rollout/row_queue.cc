#include "robocell/rollout/row_queue.h"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <memory>
#include <system_error>
#include <utility>

#include "robocell/base/io_error.h"

namespace robocell::internal {

RowQueue::RowQueue(Work work, Begin begin) : work_(std::move(work)) {
  if (begin == Begin::kAtOnce) Start();
}

RowQueue::~RowQueue() {
  {
    const std::lock_guard lock(mutex_);
    is_destroyed_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void RowQueue::Start() {
  if (!threads_.empty()) return;
  try {
    while (static_cast<int>(threads_.size()) < work_.threads)
      threads_.emplace_back([this, thread = static_cast<int>(threads_.size())] { Run(thread); });
  } catch (const std::system_error& error) {
    if (!threads_.empty()) return;  // fewer threads do the same
    throw IoError(
        fmt::format("cannot start the thread that writes rows: {}. Raise the limit of "
                    "processes (`ulimit -u`)",
                    error.what()));
  }
}

void RowQueue::Run(int thread) {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_over() || !rows_.empty(); });
    if (is_over()) return;
    const std::shared_ptr<EpisodeRow> row = std::move(rows_.front());
    rows_.pop_front();
    if (!Process(*row, taken_++, thread, lock)) return;
  }
}

bool RowQueue::Process(EpisodeRow& row, int64_t turn, int thread,
                       std::unique_lock<std::mutex>& lock) {
  std::exception_ptr thrown;
  const auto attempt = [&](const std::function<void(EpisodeRow&, int)>& what) {
    lock.unlock();
    try {
      what(row, thread);
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
  };
  if (work_.draw) attempt(work_.draw);
  changed_.wait(lock, [&] { return is_over() || written_ == turn; });
  if (is_over()) return false;
  if (!thrown) attempt(work_.write);
  ++written_;
  if (thrown) {
    failure_ = thrown;
    rows_.clear();
  }
  changed_.notify_all();
  return !is_over();
}

void RowQueue::Rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

bool RowQueue::Wait(std::unique_lock<std::mutex>& lock, const StopRequest& stop,
                    const std::function<bool()>& is_reached) {
  constexpr auto kPause = std::chrono::milliseconds(20);
  const auto is_done = [&] { return failure_ || is_reached(); };
  while (!changed_.wait_for(lock, kPause, is_done)) {
    lock.unlock();
    const bool is_stopped = ShouldStop(stop);
    lock.lock();
    if (is_stopped) return false;
  }
  return true;
}

bool RowQueue::Push(std::shared_ptr<EpisodeRow> row, const StopRequest& stop) {
  {
    std::unique_lock lock(mutex_);
    if (!threads_.empty() && !Wait(lock, stop, [&] { return waiting() < kMostAhead; }))
      return false;
    Rethrow();
    rows_.push_back(std::move(row));
  }
  changed_.notify_all();
  return true;
}

void RowQueue::ThrowFailure() {
  const std::lock_guard lock(mutex_);
  Rethrow();
}

bool RowQueue::Finish(const StopRequest& stop) {
  if (ShouldStop(stop)) return false;
  Start();
  std::unique_lock lock(mutex_);
  if (!Wait(lock, stop, [&] { return waiting() == 0; })) return false;
  Rethrow();
  return true;
}

}  // namespace robocell::internal
