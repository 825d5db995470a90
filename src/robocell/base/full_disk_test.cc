#include "robocell/base/full_disk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell {
namespace {

using ::testing::MatchesRegex;

TEST(FullDisk, SaysHowMuchIsNeededAndHowMuchThereIs) {
  EXPECT_THAT(
      SpaceHint("/tmp", 123),
      MatchesRegex("123 bytes are needed, [0-9]+ are free there. Make room and try again."));
  EXPECT_THAT(SpaceHint("/tmp", std::nullopt),
              MatchesRegex("[0-9]+ bytes are free there. Make room and try again."));
}

TEST(FullDisk, WhatOthersSayOfItGetsTheHintOnce) {
  const std::string said = WithSpaceHint("it said 'No space left on device'", "/tmp", 9);
  EXPECT_THAT(said, MatchesRegex("it said 'No space left on device'. More than 9 bytes are needed, "
                                 "[0-9]+ are free there. Make room and try again."));
  EXPECT_EQ(WithSpaceHint(said, "/tmp", 9), said);
  EXPECT_EQ(WithSpaceHint("it is on fire", "/tmp", 9), "it is on fire");
}

}  // namespace
}  // namespace robocell
