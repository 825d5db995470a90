// Tests that pointers of Git LFS are recognised, and nothing else.
#include "robocell/base/lfs_pointer.h"

#include <sys/stat.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPointer =
    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";

class LfsPointer : public ::testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& text) {
    AtomicWrite(folder_.path() / name, text);
    return folder_.path() / name;
  }

  const TempDir folder_;
};

TEST_F(LfsPointer, IsRecognisedByItsFirstLine) {
  EXPECT_TRUE(IsLfsPointer(Write("arm.stl", kPointer)));
  EXPECT_FALSE(IsLfsPointer(Write("arm.obj", "v 0 0 0\n")));
  EXPECT_FALSE(IsLfsPointer(Write("short.obj", "version")));
  EXPECT_FALSE(IsLfsPointer(Write("empty.obj", "")));
  EXPECT_FALSE(IsLfsPointer(Write("about.txt", std::string(" ") + kPointer)));
}

TEST_F(LfsPointer, RejectsFoldersPipesAndMissingFiles) {
  EXPECT_FALSE(IsLfsPointer(folder_.path()));
  EXPECT_FALSE(IsLfsPointer(folder_.path() / "missing"));
  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(IsLfsPointer(pipe)) << "a pipe is not opened";
}

TEST_F(LfsPointer, AdviceNamesTheFirstAndCountsTheOthers) {
  const fs::path whole = Write("whole.obj", "v 0 0 0\n"), a = Write("a.stl", kPointer);
  EXPECT_EQ(LfsPointerAdvice({whole}), "");
  EXPECT_EQ(LfsPointerAdvice({whole, a}),
            a.string() +
                ": a pointer of Git LFS, not the file itself: run `git lfs pull` where the "
                "repository was cloned, or download the file");
  EXPECT_EQ(LfsPointerAdvice({a, whole, Write("b.stl", kPointer)}),
            a.string() +
                ": a pointer of Git LFS, not the file itself, as 1 more file is: run `git "
                "lfs pull` where the repository was cloned, or download the files");
  EXPECT_EQ(LfsPointerAdvice({a, Write("b.stl", kPointer), Write("c.png", kPointer)}),
            a.string() +
                ": a pointer of Git LFS, not the file itself, as 2 more files are: run "
                "`git lfs pull` where the repository was cloned, or download the files");
}

}  // namespace
}  // namespace robocell::internal
