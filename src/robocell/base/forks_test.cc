#include "robocell/base/forks.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

// Returns the exit code of a fork that runs `work`.
template <class Work>
int InFork(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ForkCount, DiffersInAFork) {
  const int own = ForkCount();
  EXPECT_EQ(InFork([own] { return ForkCount() == own ? 1 : 0; }), 0);
  EXPECT_EQ(ForkCount(), own);
}

TEST(ForkCount, DiffersInAForkOfAFork) {
  const int own = ForkCount();
  EXPECT_EQ(InFork([own] {
              const int child = ForkCount();
              return InFork([own, child] {
                const int grandchild = ForkCount();
                return grandchild == own || grandchild == child ? 1 : 0;
              });
            }),
            0);
}

}  // namespace
}  // namespace robocell::internal
