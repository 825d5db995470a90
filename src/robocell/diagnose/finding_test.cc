#include "robocell/diagnose/finding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell {
namespace {

using ::testing::ElementsAre;

TEST(Finding, IsALineWithItsPlaceAndItsSubject) {
  const Finding finding{.subject = "robot 'left'", .place = "arm.yaml:9:14", .text = "it sags"};
  EXPECT_EQ(Line(finding), "arm.yaml:9:14: robot 'left': it sags");
  EXPECT_EQ(LineWithoutSubject(finding), "arm.yaml:9:14: it sags");
  EXPECT_EQ(Line({.text = "it sags"}), "it sags");
}

TEST(Finding, WarningLinesLeaveNotesOut) {
  EXPECT_THAT(WarningLines({{.severity = Severity::kNote, .text = "a"}, {.text = "b"}}),
              ElementsAre("b"));
}

}  // namespace
}  // namespace robocell
