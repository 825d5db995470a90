#include "robocell/scene/inspection/finding.h"

#include <gtest/gtest.h>

namespace robocell {
namespace {

TEST(Finding, IsALineWithItsPlaceAndItsSubject) {
  const Finding finding{.subject = "robot 'left'", .place = "arm.yaml:9:14", .text = "it sags"};
  EXPECT_EQ(Line(finding), "arm.yaml:9:14: robot 'left': it sags");
  EXPECT_EQ(LineWithoutSubject(finding), "arm.yaml:9:14: it sags");
  EXPECT_EQ(Line({.text = "it sags"}), "it sags");
}

}  // namespace
}  // namespace robocell
