#include "robocell/rollout/row_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::shared_ptr<EpisodeRow> Row(int phase) {
  auto row = std::make_shared<EpisodeRow>();
  row->phase = phase;
  return row;
}

TEST(RowQueue, WritesRowsInOrderOnASeparateThread) {
  std::vector<int> written;
  std::thread::id writer;
  RowQueue queue({.write =
                      [&](EpisodeRow& row, int) {
                        written.push_back(row.phase);
                        writer = std::this_thread::get_id();
                      }},
                 RowQueue::Begin::kAtOnce);
  for (int i = 0; i < 1000; ++i) queue.Push(Row(i), {});
  EXPECT_TRUE(queue.Finish({}));
  ASSERT_EQ(written.size(), 1000);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(written[i], i);
  EXPECT_NE(writer, std::this_thread::get_id());
}

TEST(RowQueue, WritesNothingBeforeFinishIfConfigured) {
  std::vector<int> written;
  const RowQueue::Work write = {
      .write = [&](EpisodeRow& row, int) { written.push_back(row.phase); }};
  {
    RowQueue queue(write, RowQueue::Begin::kAtFinish);
    for (int i = 0; i < 3; ++i) queue.Push(Row(i), {});
  }
  EXPECT_THAT(written, IsEmpty()) << "a rollout that is not kept";
  RowQueue queue(write, RowQueue::Begin::kAtFinish);
  for (int i = 0; i < 3; ++i) queue.Push(Row(i), {});
  EXPECT_TRUE(queue.Finish({}));
  EXPECT_THAT(written, ElementsAre(0, 1, 2));
}

TEST(RowQueue, RowsAfterFinishAreWrittenInTheBackground) {
  std::vector<int> written;
  RowQueue queue({.write = [&](EpisodeRow& row, int) { written.push_back(row.phase); }},
                 RowQueue::Begin::kAtFinish);
  queue.Push(Row(0), {});
  queue.Push(Row(1), {});
  EXPECT_TRUE(queue.Finish({}));
  EXPECT_THAT(written, ElementsAre(0, 1));
  queue.Push(Row(2), {});
  EXPECT_TRUE(queue.Finish({}));
  EXPECT_THAT(written, ElementsAre(0, 1, 2));
}

TEST(RowQueue, EveryLaterCallRethrowsTheWriterException) {
  int rows = 0;
  RowQueue queue({.write =
                      [&](EpisodeRow& row, int) {
                        ++rows;
                        if (row.phase == 1) throw IoError("the disk is full");
                      }},
                 RowQueue::Begin::kAtOnce);
  queue.Push(Row(0), {});
  queue.Push(Row(1), {});
  ExpectThrow<IoError>([&] { queue.Finish({}); }, "the disk is full");
  ExpectThrow<IoError>([&] { queue.Push(Row(2), {}); }, "the disk is full");
  ExpectThrow<IoError>([&] { queue.Finish({}); }, "the disk is full");
  EXPECT_EQ(rows, 2);
}

TEST(RowQueue, AFastRolloutWaitsForItsWriter) {
  std::atomic<int> pushed = 0, most_ahead = 0;
  int written = 0;
  RowQueue queue({.write =
                      [&](EpisodeRow&, int) {
                        most_ahead = std::max<int>(most_ahead, pushed - written);
                        ++written;
                        std::this_thread::sleep_for(std::chrono::microseconds(20));
                      }},
                 RowQueue::Begin::kAtOnce);
  for (int i = 0; i < 2000; ++i) {
    queue.Push(Row(i), {});
    ++pushed;
  }
  queue.Finish({});
  EXPECT_EQ(written, 2000);
  EXPECT_LE(most_ahead, static_cast<int>(RowQueue::kMostAhead) + 2);
}

// A writer that does not go on before it is let.
class Held {
 public:
  void Write() {
    std::unique_lock lock(mutex_);
    ++written_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return may_go_on_; });
  }
  void AwaitFirst() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return written_ > 0; });
  }
  void GoOn() {
    const std::lock_guard lock(mutex_);
    may_go_on_ = true;
    changed_.notify_all();
  }
  int written() {
    const std::lock_guard lock(mutex_);
    return written_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int written_ = 0;
  bool may_go_on_ = false;
};

// Waits until a number of threads are in it at the same time.
class Meeting {
 public:
  void Await(int threads) {
    std::unique_lock lock(mutex_);
    ++here_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return here_ >= threads; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int here_ = 0;
};

TEST(RowQueue, SeveralThreadsDrawAtOnceAndRowsAreWrittenInOrder) {
  constexpr int kThreads = 3, kRows = 600;
  Meeting meeting;
  std::vector<int> drawn_by(kRows, -1), written;
  std::array<int, kThreads> held = {-1, -1, -1};  // the row that a thread has drawn last
  Rng rng = Rng::Stream(1, "pauses");
  std::vector<int> pauses(kRows);
  for (int& pause : pauses) pause = static_cast<int>(rng.Uniform(0, 50));
  RowQueue queue({.draw =
                      [&](EpisodeRow& row, int thread) {
                        if (row.phase < kThreads) meeting.Await(kThreads);
                        std::this_thread::sleep_for(std::chrono::microseconds(pauses[row.phase]));
                        held[thread] = row.phase;
                      },
                  .write =
                      [&](EpisodeRow& row, int thread) {
                        EXPECT_EQ(held[thread], row.phase) << "a thread keeps what it has drawn";
                        drawn_by[row.phase] = thread;
                        written.push_back(row.phase);
                      },
                  .threads = kThreads},
                 RowQueue::Begin::kAtOnce);
  for (int i = 0; i < kRows; ++i) EXPECT_TRUE(queue.Push(Row(i), {}));
  EXPECT_TRUE(queue.Finish({}));
  ASSERT_EQ(written.size(), kRows);
  EXPECT_TRUE(std::ranges::is_sorted(written));
  EXPECT_THAT(std::vector(drawn_by.begin(), drawn_by.begin() + kThreads),
              ::testing::UnorderedElementsAre(0, 1, 2));
}

TEST(RowQueue, AFailureOfDrawingComesAfterAllEarlierRows) {
  for (int failing = 0; failing < 5; ++failing) {
    std::vector<int> written;
    RowQueue queue({.draw =
                        [&](EpisodeRow& row, int) {
                          if (row.phase >= failing) throw EngineError(std::to_string(row.phase));
                          std::this_thread::sleep_for(std::chrono::milliseconds(1));
                        },
                    .write = [&](EpisodeRow& row, int) { written.push_back(row.phase); },
                    .threads = 3},
                   RowQueue::Begin::kAtFinish);
    for (int i = 0; i < 8; ++i) queue.Push(Row(i), {});
    ExpectThrow<EngineError>([&] { queue.Finish({}); }, std::to_string(failing));
    ExpectThrow<EngineError>([&] { queue.Push(Row(9), {}); }, std::to_string(failing));
    ASSERT_EQ(written.size(), failing) << "as with one thread";
    for (int i = 0; i < failing; ++i) EXPECT_EQ(written[i], i);
  }
}

TEST(RowQueue, AStopRequestEndsTheWaitForTheRest) {
  Held held;
  RowQueue queue({.write = [&](EpisodeRow&, int) { held.Write(); }}, RowQueue::Begin::kAtFinish);
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(queue.Push(Row(i), [] { return true; }));
  int polls = 0;
  EXPECT_FALSE(queue.Finish([&] {
    if (++polls == 1) return false;  // before it begins
    held.AwaitFirst();
    return true;
  }));
  EXPECT_EQ(held.written(), 1);
  held.GoOn();
}

TEST(RowQueue, AStopRequestEndsTheWaitOfAPush) {
  Held held;
  RowQueue queue({.write = [&](EpisodeRow&, int) { held.Write(); }}, RowQueue::Begin::kAtOnce);
  for (size_t i = 0; i < RowQueue::kMostAhead; ++i) EXPECT_TRUE(queue.Push(Row(0), {}));
  int polls = 0;
  EXPECT_FALSE(queue.Push(Row(1), [&] { return ++polls > 2; }));
  EXPECT_EQ(polls, 3);
  held.GoOn();
  EXPECT_TRUE(queue.Finish({}));
  EXPECT_EQ(held.written(), RowQueue::kMostAhead) << "the row that was not pushed is not written";
}

}  // namespace
}  // namespace robocell::internal
