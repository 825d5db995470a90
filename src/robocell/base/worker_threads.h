// WorkerThreads: runs the same work for the numbers 0 to n-1 on persistent threads, including the
// caller's. Internal to the library.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace robocell::internal {

class WorkerThreads {
 public:
  // `threads` in all, including the caller's; 0: one for each core. At most `most`. Throws
  // ArgumentError for a number below 0, and Error if the machine has no threads left.
  WorkerThreads(int threads, int most);
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  int count() const { return static_cast<int>(threads_.size()) + 1; }

  // Returns when all work is done and rethrows the exception of the lowest number. While the caller
  // waits for the others, it calls `meanwhile` every few milliseconds; an exception of `meanwhile`
  // takes precedence, and is rethrown when all work is done.
  void Run(int count, const std::function<void(int)>& work,
           const std::function<void()>& meanwhile = {});

 private:
  void Start(int count);
  void Stop();
  void Wait();
  void Take();
  void WaitForOthers(const std::function<void()>& meanwhile);

  std::mutex mutex_;
  std::condition_variable begin_, end_;
  uint64_t round_ = 0;
  bool stop_ = false;
  int busy_ = 0;
  int count_ = 0;
  const std::function<void(int)>* work_ = nullptr;
  std::atomic<int> next_{0};
  std::vector<std::exception_ptr> thrown_;
  std::vector<std::thread> threads_;
};

}  // namespace robocell::internal
