#include "robocell/data/file_lock.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

bool IsFree(const std::filesystem::path& path, LockKind kind) {
  return FileLock::Try(path, kind).has_value();
}

// Returns true if another process can take the lock.
bool IsFreeElsewhere(const std::filesystem::path& path, LockKind kind) {
  const pid_t child = fork();
  if (child == 0) _exit(IsFree(path, kind) ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(FileLock, AnExclusiveLockExcludesAllOthers) {
  TempDir folder;
  const auto path = folder / "lock";
  {
    const auto lock = FileLock::Try(path, LockKind::kExclusive);
    ASSERT_TRUE(lock.has_value());
    EXPECT_TRUE(lock->holds());
    for (const LockKind kind : {LockKind::kShared, LockKind::kExclusive}) {
      EXPECT_FALSE(IsFree(path, kind)) << "in this process";
      EXPECT_FALSE(IsFreeElsewhere(path, kind)) << "in another";
    }
  }
  EXPECT_TRUE(IsFreeElsewhere(path, LockKind::kExclusive)) << "it went out of scope";
}

TEST(FileLock, SharedLocksExcludeAnExclusiveOne) {
  TempDir folder;
  const auto path = folder / "lock";
  FileLock::Try(path, LockKind::kExclusive);  // creates the file
  const auto lock = FileLock::Try(path, LockKind::kShared);
  ASSERT_TRUE(lock.has_value());
  EXPECT_TRUE(IsFreeElsewhere(path, LockKind::kShared));
  EXPECT_FALSE(IsFreeElsewhere(path, LockKind::kExclusive));
}

TEST(FileLock, MovesWithItsOwner) {
  TempDir folder;
  const auto path = folder / "lock";
  std::optional<FileLock> kept;
  {
    auto lock = FileLock::Try(path, LockKind::kExclusive);
    ASSERT_TRUE(lock.has_value());
    kept = std::move(lock);
  }
  EXPECT_FALSE(IsFreeElsewhere(path, LockKind::kExclusive));
  kept.reset();
  EXPECT_TRUE(IsFreeElsewhere(path, LockKind::kExclusive));
}

TEST(FileLock, ASharedLockNeedsAnExistingFile) {
  TempDir folder;
  ExpectThrow<IoError>([&] { FileLock::Try(folder / "none", LockKind::kShared); }, "none");
  ExpectThrow<IoError>([&] { FileLock::Try(folder / "no/lock", LockKind::kExclusive); }, "no/lock");
}

}  // namespace
}  // namespace robocell
