// Tests that the pointers of Git LFS among a model's files are named.
#include "robocell/assets/lfs_pointers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::assets {
namespace {

using ::testing::HasSubstr;

TEST(LfsPointers, AreTheModelItselfOrAFileThatItNames) {
  const TempDir folder;
  const auto write = [&](const char* name, const char* text) {
    AtomicWrite(folder.path() / name, text);
    return (folder.path() / name).string();
  };
  const char* pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n";
  const std::string model =
      write("arm.xml", "<mujoco><asset><mesh file='a.obj'/><mesh file='b.stl'/></asset></mujoco>");
  write("a.obj", "v 0 0 0\n");
  EXPECT_EQ(AdviceAboutPointers(model), "");
  const std::string mesh = write("b.stl", pointer);
  EXPECT_THAT(AdviceAboutPointers(model), HasSubstr(mesh + ": a pointer of Git LFS"));
  EXPECT_THAT(AdviceAboutPointers(mesh), HasSubstr(mesh + ": a pointer of Git LFS"));
  EXPECT_EQ(AdviceAboutPointers((folder.path() / "missing.xml").string()), "");
}

}  // namespace
}  // namespace robocell::assets
