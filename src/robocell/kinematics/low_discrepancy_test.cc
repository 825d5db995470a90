#include "robocell/kinematics/low_discrepancy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace robocell::internal {
namespace {

// Returns the largest difference between the share of points below a number and that number.
double StarDiscrepancy(std::vector<double> points) {
  std::sort(points.begin(), points.end());
  const double n = static_cast<double>(points.size());
  double worst = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    worst = std::max({worst, std::abs(points[i] - static_cast<double>(i) / n),
                      std::abs(points[i] - static_cast<double>(i + 1) / n)});
  }
  return worst;
}

TEST(LowDiscrepancy, RadicalInverseMirrorsTheDigits) {
  const double binary[] = {0, 1. / 2, 1. / 4, 3. / 4, 1. / 8, 5. / 8, 3. / 8, 7. / 8};
  for (uint64_t i = 0; i < 8; ++i) EXPECT_EQ(RadicalInverse(i, 2), binary[i]);
  const double ternary[] = {0, 1. / 3, 2. / 3, 1. / 9, 4. / 9, 7. / 9};
  for (uint64_t i = 0; i < 6; ++i) EXPECT_NEAR(RadicalInverse(i, 3), ternary[i], 1e-15);
}

TEST(LowDiscrepancy, EveryPowerOfTheBaseCoversAllIntervals) {
  for (const uint64_t base : {2, 3, 5}) {
    const uint64_t count = base * base * base;
    std::vector<int> hits(count);
    for (uint64_t i = 0; i < count; ++i) {
      // Takes the middle of its share, so that rounding does not matter.
      const double in_share = RadicalInverse(i, base) * static_cast<double>(count) + 0.5;
      ++hits.at(static_cast<size_t>(in_share));
    }
    EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), static_cast<std::ptrdiff_t>(count)) << base;
  }
}

TEST(LowDiscrepancy, BothSequencesSpreadBetterThanRandomPoints) {
  constexpr int kCount = 1000;  // random points would have a discrepancy of about 0.03
  for (int dimension = 0; dimension < kMaxChainJoints; ++dimension) {
    std::vector<double> points;
    for (int k = 0; k < kCount; ++k) points.push_back(LowDiscrepancy(k, dimension));
    EXPECT_GE(*std::min_element(points.begin(), points.end()), 0);
    EXPECT_LT(*std::max_element(points.begin(), points.end()), 1);
    EXPECT_LT(StarDiscrepancy(points), 0.01) << dimension;
  }
  std::vector<double> points;
  for (uint64_t k = 1; k <= kCount; ++k) points.push_back(RadicalInverse(k, 2));
  EXPECT_LT(StarDiscrepancy(points), 0.01);
}

}  // namespace
}  // namespace robocell::internal
