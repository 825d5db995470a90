#include "robocell/kinematics/on_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

namespace robocell::internal {
namespace {

TEST(OnThreads, CallsEveryNumberOnceAndTheFirstOnTheCallersThread) {
  for (const int threads : {1, 2, 5}) {
    std::atomic<int> sum = 0;
    std::thread::id first;
    OnThreads(threads, [&](int t) {
      sum += 1 << t;
      if (t == 0) first = std::this_thread::get_id();
    });
    EXPECT_EQ(sum, (1 << threads) - 1);
    EXPECT_EQ(first, std::this_thread::get_id());
  }
}

TEST(OnThreads, RethrowsExceptionsAfterAllThreadsEnd) {
  for (const int thrower : {0, 1, 2}) {
    std::atomic<int> ended = 0;
    try {
      OnThreads(3, [&](int t) {
        ++ended;
        if (t == thrower) throw std::runtime_error("number " + std::to_string(t));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), "number " + std::to_string(thrower));
    }
    EXPECT_EQ(ended, 3);
  }
}

TEST(OnThreads, RethrowsTheExceptionOfTheLowestNumber) {
  try {
    OnThreads(4, [](int t) {
      if (t > 0) throw t;
    });
    FAIL() << "nothing was thrown";
  } catch (const int number) {
    EXPECT_EQ(number, 1);
  }
}

}  // namespace
}  // namespace robocell::internal
