#include "robocell/viewer/pacing.h"

#include <gtest/gtest.h>

#include <limits>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

TEST(Pacing, KeepsTheSimulationAtTheFactorOfRealTime) {
  for (const double factor : {0.25, 1., 4.}) {
    Pacing pacing;
    pacing.set_factor(factor);
    double simulated = 0, wall = 100;
    for (int i = 0; i < 3000; ++i) {
      simulated += 0.002;
      wall += 1e-5;  // the step's own time
      wall += pacing.Wait(simulated, wall);
    }
    EXPECT_NEAR((wall - 100) * factor, simulated, 0.01);
    EXPECT_NEAR(pacing.measured(), factor, 0.02 * factor);
  }
}

TEST(Pacing, NeverWaitsAtFactorZero) {
  Pacing pacing;
  pacing.set_factor(0);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(pacing.Wait(i, 1e-3 * i), 0);
  EXPECT_NEAR(pacing.measured(), 1000, 1);
}

TEST(Pacing, DoesNotCatchUpAfterASlowStretch) {
  Pacing pacing;
  pacing.Wait(0, 0);
  pacing.Wait(0.1, 60);  // a minute for a tenth of a second
  EXPECT_NEAR(pacing.Wait(0.2, 60), 0.1, 1e-9);
}

TEST(Pacing, StartsAgainWhenTimeGoesBack) {
  Pacing pacing;
  pacing.Wait(50, 10);
  EXPECT_EQ(pacing.Wait(0, 10.1), 0);
  EXPECT_NEAR(pacing.Wait(0.5, 10.1), 0.5, 1e-9);
}

TEST(Pacing, PicturesTakeAtMostHalfOfTheTime) {
  Pacing pacing;
  EXPECT_TRUE(pacing.ShouldDraw(0));
  pacing.Drew(0, 0.001, 50);
  EXPECT_FALSE(pacing.ShouldDraw(0.019));
  EXPECT_TRUE(pacing.ShouldDraw(0.021));
  pacing.Drew(1, 1.1, 50);  // a slow picture
  EXPECT_FALSE(pacing.ShouldDraw(1.19));
  EXPECT_TRUE(pacing.ShouldDraw(1.21));
}

TEST(Pacing, RejectsFactorsThatMeanNothing) {
  Pacing pacing;
  for (const double bad :
       {-1., std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(pacing.set_factor(bad), ArgumentError);
  EXPECT_EQ(pacing.factor(), 1);
}

}  // namespace
}  // namespace robocell::internal
