#include "robocell/base/temporary_name.h"

#include <unistd.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(TemporaryName, RoundTrips) {
  const auto parsed = TemporaryName::Parse(TemporaryName{"steps.v2.h5", 4711, 3}.Text());
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->name, "steps.v2.h5");
  EXPECT_EQ(parsed->process, 4711);
  EXPECT_EQ(parsed->number, 3u);
}

TEST(TemporaryName, OfAWorkFolderNamesItsProcess) {
  TempDir temp;
  const auto parsed =
      TemporaryName::Parse(MakeTempDirectory(temp.path(), "s0000_e0001").filename().string());
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->name, "s0000_e0001");
  EXPECT_EQ(parsed->process, getpid());
}

TEST(TemporaryName, RejectsOtherNames) {
  for (const char* name : {"", ".", ".partial", "e1.7.1.partial", ".e1.7.1", ".e1.x.1.partial",
                           ".e1.7..partial", ".lock-0-of-2"}) {
    EXPECT_FALSE(TemporaryName::Parse(name)) << name;
  }
}

}  // namespace
}  // namespace robocell::internal
