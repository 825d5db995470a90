#include "robocell/base/io_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace robocell {
namespace {

using ::testing::MatchesRegex;

TEST(FullDisk, ReportsNeededAndFreeBytes) {
  EXPECT_THAT(
      SpaceHint("/tmp", 123),
      MatchesRegex("123 bytes are needed, [0-9]+ are free there. Make room and try again."));
  EXPECT_THAT(SpaceHint("/tmp", std::nullopt),
              MatchesRegex("[0-9]+ bytes are free there. Make room and try again."));
}

TEST(FullDisk, AddsOneConsistentHintToOtherMessages) {
  constexpr uint64_t kWritten = uint64_t{1} << 50;
  for (const char* own :
       {"", ". 12 bytes are needed, 0 are free there. Make room and try again."}) {
    const std::string message =
        WithSpaceHint(std::string("it said 'No space left on device'") + own, "/tmp", kWritten);
    EXPECT_THAT(message,
                MatchesRegex("it said 'No space left on device'. More than [0-9]+ bytes are "
                             "needed, [0-9]+ are free there. Make room and try again."));
    uint64_t needed = 0, free = 0;
    ASSERT_EQ(std::sscanf(message.c_str(), "%*[^.]. More than %lu bytes are needed, %lu are",
                          &needed, &free),
              2);
    EXPECT_GE(needed, kWritten) << "what it had already";
    EXPECT_EQ(needed, free) << "when that is gone";
  }
  EXPECT_EQ(WithSpaceHint("it is on fire", "/tmp", 9), "it is on fire");
  EXPECT_EQ(WithSpaceHint("Disk quota exceeded. 5 bytes are free there. Make room and try again.",
                          "/tmp", 9),
            "Disk quota exceeded. More than 9 bytes are needed, and the quota leaves less. Make "
            "room and try again.");
}

}  // namespace
}  // namespace robocell
