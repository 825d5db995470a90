#include "robocell/base/idle_pool.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace robocell::internal {
namespace {

struct Counted {
  explicit Counted(std::string its_name) : name(std::move(its_name)) { ++alive; }
  Counted(Counted&& other) noexcept : name(std::move(other.name)) { ++alive; }
  Counted& operator=(Counted&&) noexcept = default;
  ~Counted() { --alive; }
  std::string name;
  static inline std::atomic<int> alive = 0;
};

auto Named(const std::string& name) {
  return [name](const Counted& value) { return value.name == name; };
}

TEST(IdlePool, AValueIsTakenOnce) {
  IdlePool<Counted> pool(3);
  pool.Give(Counted("a"));
  pool.Give(Counted("b"));
  EXPECT_FALSE(pool.Take(Named("c")));
  const auto taken = pool.Take(Named("a"));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->name, "a");
  EXPECT_FALSE(pool.Take(Named("a")));
  EXPECT_EQ(pool.idle(), 1u);
}

TEST(IdlePool, DropsTheLongestIdleFirst) {
  const int before = Counted::alive;
  IdlePool<Counted> pool(2);
  pool.Give(Counted("a"));
  pool.Give(Counted("b"));
  pool.Give(*pool.Take(Named("a")));
  pool.Give(Counted("c"));
  EXPECT_FALSE(pool.Take(Named("b")));
  EXPECT_EQ(pool.idle(), 2u);
  EXPECT_EQ(Counted::alive - before, 2);
  pool.Clear();
  EXPECT_EQ(pool.idle(), 0u);
  EXPECT_EQ(Counted::alive, before);
}

TEST(IdlePool, ACopyLeavesTheValueAndMakesItTheLastUsed) {
  IdlePool<std::shared_ptr<std::string>> pool(2);
  const auto is = [](const char* text) {
    return [text](const auto& value) { return *value == text; };
  };
  pool.Give(std::make_shared<std::string>("a"));
  pool.Give(std::make_shared<std::string>("b"));
  EXPECT_EQ(pool.Copy(is("a")), pool.Copy(is("a")));
  EXPECT_FALSE(pool.Copy(is("c")));
  pool.Give(std::make_shared<std::string>("c"));
  EXPECT_TRUE(pool.Copy(is("a")));
  EXPECT_FALSE(pool.Copy(is("b")));
}

TEST(IdlePool, AForkLeavesBothProcessesAnEmptyPoolThatWorks) {
  IdlePool<Counted> pool(2);
  const int before = Counted::alive;
  pool.Give(Counted("a"));
  const pid_t child = fork();
  const auto works = [&] {
    const bool empty = pool.idle() == 0 && !pool.Take(Named("a")) && Counted::alive == before;
    pool.Give(Counted("b"));
    return empty && pool.idle() == 1 && pool.Take(Named("b")).has_value();
  };
  if (child == 0) _exit(works() ? 0 : 1);
  EXPECT_TRUE(works());
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(IdlePool, ADestroyedPoolDoesNotAffectForks) {
  { IdlePool<Counted>(2).Give(Counted("a")); }
  const pid_t child = fork();
  if (child == 0) _exit(0);
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(IdlePool, AForkWhileOtherThreadsUseItLeavesTheChildNoLockedMutex) {
  IdlePool<Counted> pool(2);
  std::atomic<bool> stop = false;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 2; ++i) {
    threads.emplace_back([&] {
      while (!stop) {
        auto taken = pool.Take([](const Counted&) { return true; });
        pool.Give(taken ? std::move(*taken) : Counted("x"));
      }
    });
  }
  for (int i = 0; i < 50; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(20);  // ends a child that waits for a lock that nobody holds
      pool.Give(Counted("y"));
      _exit(pool.Take(Named("y")) ? 0 : 1);
    }
    int status = 1;
    waitpid(child, &status, 0);
    ASSERT_EQ(status, 0);
  }
  stop = true;
}

}  // namespace
}  // namespace robocell::internal
