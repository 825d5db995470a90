#include "robocell/base/make_directories.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

TEST(MakeDirectoriesTest, MakesFoldersBelowFoldersAndKeepsThoseThatExist) {
  const TempDir temp;
  for (const fs::path& path : {temp.path() / "a/b/c", temp.path() / "a/b/d/"}) {
    MakeDirectories(path);
    EXPECT_TRUE(fs::is_directory(path)) << path;
  }
  AtomicWrite(temp.path() / "a/b/c/file", "x");
  MakeDirectories(temp.path() / "a/b/c");
  EXPECT_EQ(ReadFile(temp.path() / "a/b/c/file"), "x");
}

TEST(MakeDirectoriesTest, FollowsLinksBeforeDots) {
  const TempDir temp;
  MakeDirectories(temp.path() / "real/inner");
  fs::create_directory_symlink("real/inner", temp.path() / "link");
  MakeDirectories(temp.path() / "link/../made/x");
  EXPECT_TRUE(fs::is_directory(temp.path() / "real/made/x"));
  EXPECT_FALSE(fs::exists(temp.path() / "made"));
  MakeDirectories(temp.path() / "new/../other");
  EXPECT_TRUE(fs::is_directory(temp.path() / "other"));
}

TEST(MakeDirectoriesTest, NamesAFolderBelowAFile) {
  const TempDir temp;
  AtomicWrite(temp.path() / "file", "x");
  ExpectThrow<IoError>([&] { MakeDirectories(temp.path() / "file/d", "the dataset's folder"); },
                       "cannot create the dataset's folder '" + temp.path().native());
}

}  // namespace
}  // namespace robocell::internal
