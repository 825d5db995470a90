// Tests the lanes' sine and cosine against those of the C library with more digits, in units of the
// last place of a number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/testing/instruction_sets.h"
#include "robocell/testing/lane_sin_cos.h"

namespace robocell::internal {
namespace {

struct SinesAndCosines {
  std::vector<double> sine, cosine;
};

SinesAndCosines OfLanes(const std::vector<double>& angles, bool any) {
  SinesAndCosines out{std::vector<double>(angles.size()), std::vector<double>(angles.size())};
  LaneSinCos(angles, any, out.sine, out.cosine);
  return out;
}

// Values below `least` count as equal to it.
double Ulps(double got, long double exact, double least) {
  const double size = std::max(std::abs(static_cast<double>(exact)), least);
  const double ulp = std::nextafter(size, 2.0) - size;
  return static_cast<double>(std::abs(static_cast<long double>(got) - exact)) / ulp;
}

double WorstUlps(const std::vector<double>& angles, bool any, double least) {
  const SinesAndCosines got = OfLanes(angles, any);
  double worst = 0;
  for (size_t i = 0; i < angles.size(); ++i) {
    const auto angle = static_cast<long double>(angles[i]);
    worst = std::max({worst, Ulps(got.sine[i], std::sin(angle), least),
                      Ulps(got.cosine[i], std::cos(angle), least)});
  }
  return worst;
}

// Covers the range evenly, and all multiples of an eighth turn, where sine and cosine change
// places.
std::vector<double> Angles(Rng* rng, double largest) {
  std::vector<double> angles;
  for (int i = 0; i < 8000; ++i) angles.push_back(rng->Uniform(-largest, largest));
  const double eighths = std::floor(largest / (M_PI / 4));
  for (int i = 0; i < 8000; ++i) {
    const double near = std::round(rng->Uniform(-eighths, eighths)) * (M_PI / 4);
    angles.push_back(near + rng->Normal() * std::pow(10, -rng->Uniform(1, 16)));
  }
  return angles;
}

TEST(LaneSinCos, IsWithinTwoUnitsInTheLastPlaceOnEveryInstructionSet) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(1, "sincos");
    for (const double largest : {1e-3, M_PI, 30.0, 1e3, 1e5})
      EXPECT_LT(WorstUlps(Angles(&rng, largest), false, 1e-3), 2) << largest;
  });
}

TEST(LaneSinCos, ReducesAnyAngleToOneTurn) {
  OnEveryInstructionSet([](const std::string&) {
    Rng rng = Rng::Stream(2, "sincos");
    for (const double largest : {1e6, 1e9, 1e15})
      EXPECT_LT(WorstUlps(Angles(&rng, largest), true, 1), 3) << largest;
  });
}

TEST(LaneSinCos, IsExactAtZeroAndNanForNonFiniteNumbers) {
  OnEveryInstructionSet([](const std::string&) {
    const std::vector<double> angles = {0.0, -0.0, NAN, INFINITY, -INFINITY, 1e300, 5e-324, 1};
    const SinesAndCosines got = OfLanes(angles, true);
    EXPECT_EQ(got.sine[0], 0);
    EXPECT_EQ(got.cosine[0], 1);
    EXPECT_EQ(got.cosine[1], 1);
    for (const size_t i : {2, 3, 4})
      EXPECT_TRUE(std::isnan(got.sine[i]) && std::isnan(got.cosine[i]));
    EXPECT_NEAR(got.sine[5], std::sin(1e300), 1e-15);
    EXPECT_EQ(got.sine[6], 5e-324);
  });
}

}  // namespace
}  // namespace robocell::internal
