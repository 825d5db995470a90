#include "robocell/base/worker_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(WorkerThreads, DoEachNumberOnce) {
  for (const int threads : {1, 2, 5}) {
    WorkerThreads workers(threads, 8);
    for (const int count : {0, 1, 3, 100}) {
      std::vector<std::atomic<int>> done(static_cast<size_t>(count));
      workers.Run(count, [&](int i) { ++done[static_cast<size_t>(i)]; });
      for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1) << threads << ", " << count;
    }
  }
}

TEST(WorkerThreads, RethrowTheExceptionOfTheLowestNumberAtTheEnd) {
  WorkerThreads workers(3, 3);
  std::atomic<int> done = 0;
  const auto run = [&] {
    workers.Run(20, [&](int i) {
      ++done;
      if (i % 7 == 5) throw std::runtime_error("of " + std::to_string(i));
    });
  };
  ExpectThrow<std::runtime_error>(run, "of 5");
  EXPECT_EQ(done, 20);
  done = 0;
  workers.Run(4, [&](int) { ++done; });
  EXPECT_EQ(done, 4) << "they go on after an error";
}

TEST(WorkerThreads, CallTheCallbackDuringWork) {
  WorkerThreads workers(2, 2);
  std::atomic<bool> other_works = false;
  std::atomic<bool> called = false;
  const std::thread::id caller = std::this_thread::get_id();
  // The caller keeps one number until the other thread has taken the second one, however late that
  // thread wakes up. The other thread then works until the callback was called.
  const auto work = [&](int) {
    const bool on_caller = std::this_thread::get_id() == caller;
    if (!on_caller) other_works = true;
    const std::atomic<bool>& awaited = on_caller ? other_works : called;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!awaited && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  workers.Run(2, work, [&] { called = true; });
  EXPECT_TRUE(called);
}

TEST(WorkerThreads, RejectANegativeNumber) {
  ExpectThrow<ArgumentError>([] { const WorkerThreads workers(-1, 2); }, "-1");
}

}  // namespace
}  // namespace robocell::internal
