#include "robocell/base/host.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

TEST(Host, IsNamedAsTheSystemNamesIt) {
  char name[256] = {};
  ASSERT_EQ(gethostname(name, sizeof(name) - 1), 0);
  EXPECT_EQ(HostName(), name);
}

TEST(ProcessStart, IsConstant) {
  const auto start = ProcessStart(getpid());
  ASSERT_TRUE(start.has_value());
  EXPECT_EQ(ProcessStart(getpid()), start);
}

TEST(ProcessStart, OfAChildIsNotBeforeItsParents) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[1]);
    char byte;
    _exit(read(ends[0], &byte, 1) == 0 ? 0 : 1);  // until the parent has finished
  }
  close(ends[0]);
  const auto start = ProcessStart(child);
  close(ends[1]);
  waitpid(child, nullptr, 0);
  ASSERT_TRUE(start.has_value());
  EXPECT_GE(*start, *ProcessStart(getpid()));
  EXPECT_EQ(ProcessStart(child), std::nullopt) << "it has ended";
}

TEST(ProcessStart, IsUnsetForUnusedProcessIds) {
  EXPECT_EQ(ProcessStart(-1), std::nullopt);
  EXPECT_EQ(ProcessStart(int64_t{1} << 40), std::nullopt);
}

}  // namespace
}  // namespace robocell::internal
