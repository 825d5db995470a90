#include "robocell/base/units.h"

#include <cmath>

#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

TEST(Units, AHalfTurnIsPi) {
  EXPECT_DOUBLE_EQ(Radians(180), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(Degrees(std::acos(0.0)), 90);
  for (double degrees = -720; degrees <= 720; degrees += 7.5) {
    EXPECT_NEAR(Degrees(Radians(degrees)), degrees, 1e-12);
  }
}

}  // namespace
}  // namespace robocell::internal
