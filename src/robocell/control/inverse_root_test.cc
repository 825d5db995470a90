#include "robocell/control/inverse_root.h"

#include <gtest/gtest.h>

#include <cmath>

namespace robocell::internal {
namespace {

// Returns the value of the sum at one eigenvalue, where the largest is 1; 1 / sqrt(value) is exact.
double SumAt(const InverseRoot& root, double value) {
  double sum = 0;
  for (int k = 0; k < root.n_poles; ++k) sum += root.weight[k] / (value + root.shift[k]);
  return sum;
}

TEST(InverseRoot, IsWithinATenThousandthOverItsRange) {
  for (int i = 0; i < kInverseRoots; ++i) {
    const InverseRoot& root = InverseRoots()[i];
    for (int k = 0; k <= 1000; ++k) {
      const double value = std::pow(root.range, -k / 1000.0);
      EXPECT_NEAR(SumAt(root, value) * std::sqrt(value), 1, 1e-4) << root.range << " " << value;
    }
  }
}

TEST(InverseRoot, UnderestimatesBelowItsRange) {
  for (int i = 0; i < kInverseRoots; ++i) {
    const InverseRoot& root = InverseRoots()[i];
    for (const double below : {10.0, 1e3, 1e6}) {
      const double value = 1 / (root.range * below);
      EXPECT_LT(SumAt(root, value) * std::sqrt(value), 1);
      EXPECT_GT(SumAt(root, value), 0);
    }
  }
}

TEST(InverseRoot, EachHasAWiderRangeAndZeroPadding) {
  for (int i = 0; i < kInverseRoots; ++i) {
    const InverseRoot& root = InverseRoots()[i];
    ASSERT_LE(root.n_poles, InverseRoot::kMostPoles);
    for (int k = root.n_poles; k < InverseRoot::kMostPoles; ++k) EXPECT_EQ(root.weight[k], 0);
    if (i > 0) {
      EXPECT_GT(root.range, InverseRoots()[i - 1].range);
    }
  }
  EXPECT_EQ(InverseRoots()[0].n_poles, 7);
  EXPECT_EQ(InverseRoots()[0].shift[7], 0);
}

}  // namespace
}  // namespace robocell::internal
