// The bands of an image: every row in one of them, each on a scratch of its own.
#include "robocell/render/soft_threads.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(SoftThreads, BandsCoverAllRowsOnce) {
  for (const int count : {1, 2, 3, 7}) {
    SoftThreads threads(count);
    ASSERT_EQ(threads.count(), count);
    for (const int rows : {1, 2, 6, 7, 120}) {
      std::mutex mutex;
      std::vector<int> drawn(static_cast<size_t>(rows), 0);
      std::set<int> numbers;
      std::set<const SoftScratch*> scratches;
      threads.InBands(rows, [&](SoftRows band, int number) {
        const std::lock_guard lock(mutex);
        for (int row = band.begin; row < band.end; ++row) ++drawn[static_cast<size_t>(row)];
        numbers.insert(number);
        scratches.insert(threads.scratch(number));
      });
      for (const int times : drawn) EXPECT_EQ(times, 1) << count << " threads, " << rows << " rows";
      EXPECT_EQ(*numbers.begin(), 0);
      EXPECT_EQ(*numbers.rbegin(), static_cast<int>(numbers.size()) - 1);
      EXPECT_EQ(scratches.size(), numbers.size());
    }
  }
}

TEST(SoftThreads, DefaultToTheNumberOfCores) {
  EXPECT_EQ(SoftThreads(0).count(), static_cast<int>(std::thread::hardware_concurrency()));
  ExpectThrow<ArgumentError>([] { SoftThreads threads(-1); }, "-1");
}

TEST(SoftThreads, OneThreadIsTheCallersThread) {
  SoftThreads one(1);
  std::thread::id drawn;
  one.InBands(5, [&](SoftRows, int) { drawn = std::this_thread::get_id(); });
  EXPECT_EQ(drawn, std::this_thread::get_id());
}

}  // namespace
}  // namespace robocell::internal
