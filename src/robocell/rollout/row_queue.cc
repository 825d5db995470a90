#include "robocell/rollout/row_queue.h"

#include <fmt/format.h>

#include <chrono>
#include <system_error>
#include <utility>

#include "robocell/base/io_error.h"

namespace robocell::internal {

RowQueue::RowQueue(std::function<void(EpisodeRow&)> write, Begin begin) : write_(std::move(write)) {
  if (begin == Begin::kAtOnce) Start();
}

RowQueue::~RowQueue() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void RowQueue::Start() {
  if (thread_.joinable()) return;
  try {
    thread_ = std::thread([this] { Run(); });
  } catch (const std::system_error& error) {
    throw IoError(
        fmt::format("cannot start the thread that writes rows: {}. Raise the limit of "
                    "processes (`ulimit -u`)",
                    error.what()));
  }
}

void RowQueue::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_over_ || !rows_.empty(); });
    if (is_over_) return;
    const std::shared_ptr<EpisodeRow> row = std::move(rows_.front());
    rows_.pop_front();
    is_writing_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
      write_(*row);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    is_writing_ = false;
    if (failure) {
      failure_ = failure;
      rows_.clear();
    }
    changed_.notify_all();
    if (failure) return;
  }
}

void RowQueue::Rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

bool RowQueue::Wait(std::unique_lock<std::mutex>& lock, const StopRequest& stop,
                    const std::function<bool()>& is_reached) {
  constexpr auto kPause = std::chrono::milliseconds(20);
  const auto is_over = [&] { return failure_ || is_reached(); };
  while (!changed_.wait_for(lock, kPause, is_over)) {
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
    if (thread_.joinable() && !Wait(lock, stop, [&] { return waiting() < kMostAhead; }))
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
