#include "robocell/base/worker_threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

constexpr std::chrono::milliseconds kMeanwhile{10};

}  // namespace

WorkerThreads::WorkerThreads(int threads, int most) {
  if (threads < 0)
    throw ArgumentError(fmt::format("threads is {}; 0 for one for each core, or more", threads));
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int count = std::min(threads > 0 ? threads : cores, most);
  try {
    Start(count);
  } catch (const std::system_error& error) {
    Stop();
    throw Error(fmt::format("thread {} of {} could not be started ({}); set fewer with threads",
                            threads_.size() + 2, count, error.what()));
  } catch (...) {
    Stop();
    throw;
  }
}

WorkerThreads::~WorkerThreads() { Stop(); }

void WorkerThreads::Start(int count) {
  for (int i = 1; i < count; ++i) threads_.emplace_back([this] { Wait(); });
}

void WorkerThreads::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  begin_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerThreads::Wait() {
  for (uint64_t seen = 0;;) {
    {
      std::unique_lock lock(mutex_);
      begin_.wait(lock, [&] { return stop_ || round_ != seen; });
      if (stop_) return;
      seen = round_;
    }
    Take();
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) end_.notify_one();
  }
}

void WorkerThreads::Take() {
  for (int i = next_++; i < count_; i = next_++) {
    try {
      (*work_)(i);
    } catch (...) {
      thrown_[i] = std::current_exception();
    }
  }
}

void WorkerThreads::WaitForOthers(const std::function<void()>& meanwhile) {
  const auto done = [&] { return busy_ == 0; };
  std::exception_ptr thrown;
  std::unique_lock lock(mutex_);
  while (meanwhile && !thrown && !end_.wait_for(lock, kMeanwhile, done)) {
    lock.unlock();
    try {
      meanwhile();
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
  }
  end_.wait(lock, done);
  if (thrown) std::rethrow_exception(thrown);
}

void WorkerThreads::Run(int count, const std::function<void(int)>& work,
                        const std::function<void()>& meanwhile) {
  {
    const std::lock_guard lock(mutex_);
    count_ = count;
    work_ = &work;
    next_ = 0;
    thrown_.assign(static_cast<size_t>(count), nullptr);
    busy_ = static_cast<int>(threads_.size());
    ++round_;
  }
  begin_.notify_all();
  Take();
  WaitForOthers(meanwhile);
  for (const std::exception_ptr& thrown : thrown_) {
    if (thrown) std::rethrow_exception(thrown);
  }
}

}  // namespace robocell::internal
