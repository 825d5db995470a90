#include "robocell/data/work_folder.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> NamesIn(const TempDir& folder) { return FolderNames(folder.path()); }

TEST(WorkFolder, IsHiddenAndLockedWhileInUse) {
  TempDir folder;
  const WorkFolder work(folder.path(), "e1");
  ASSERT_EQ(NamesIn(folder).size(), 1u);
  const std::string name = NamesIn(folder)[0];
  EXPECT_TRUE(IsTemporaryName(name)) << name;
  EXPECT_TRUE(fs::is_directory(work.path()));
  EXPECT_FALSE(TryLockOfWork(folder / name, LockKind::kExclusive).has_value());
}

TEST(WorkFolder, LeavesNothingWithoutACommit) {
  TempDir folder;
  {
    const WorkFolder work(folder.path(), "e1");
    AtomicWrite(work.path() / "steps.h5", "rows");
  }
  EXPECT_TRUE(NamesIn(folder).empty());
  {
    WorkFolder work(folder.path(), "e1");
    AtomicWrite(work.path() / "steps.h5", "rows");
    work.Commit(folder / "e1");
    EXPECT_TRUE(work.committed());
  }
  EXPECT_EQ(NamesIn(folder), std::vector<std::string>{"e1"});
  EXPECT_EQ(ReadFile(folder / "e1/steps.h5"), "rows");
}

TEST(WorkFolder, NeverReplacesAFolder) {
  TempDir folder;
  AtomicWrite(folder / "e1", "mine");
  WorkFolder work(folder.path(), "e1");
  ExpectThrow<IoError>([&] { work.Commit(folder / "e1"); }, "e1");
  EXPECT_FALSE(work.committed());
  EXPECT_EQ(ReadFile(folder / "e1"), "mine");
}

TEST(WorkFolder, RequiresItsParent) {
  TempDir folder;
  ExpectThrow<IoError>([&] { WorkFolder(folder / "none", "e1"); }, "none");
}

}  // namespace
}  // namespace robocell::internal
