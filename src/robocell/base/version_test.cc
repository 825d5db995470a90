#include "robocell/base/version.h"

#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

TEST(Version, IsThatOfTheBuildFile) {
  const std::string build = ReadFile(SourceDir() + "/CMakeLists.txt");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(build, match, std::regex("project\\(robocell VERSION ([0-9.]+)")));
  EXPECT_EQ(Version(), match[1].str());
  EXPECT_EQ(kHeaderVersion, match[1].str());
}

}  // namespace
}  // namespace robocell
