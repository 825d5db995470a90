#include "robocell/base/small_arrays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace robocell {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = std::numeric_limits<double>::max();

// Covers every size, at every alignment, without touching neighbouring bytes.
TEST(SmallArrays, AreCopiedToTheByte) {
  for (size_t bytes = 0; bytes < 100; ++bytes) {
    for (size_t shift = 0; shift < 8; ++shift) {
      std::vector<char> from(bytes + 16), to(bytes + 16, 'x');
      for (size_t i = 0; i < from.size(); ++i) from[i] = static_cast<char>(i * 7 + 1);
      std::vector<char> expected = to;
      std::memcpy(expected.data() + 3, from.data() + shift, bytes);
      CopySmall(from.data() + shift, bytes, to.data() + 3);
      EXPECT_EQ(to, expected) << bytes;
    }
  }
}

TEST(SmallArrays, AreWithinALimitIfAllMagnitudesAre) {
  for (size_t n = 0; n < 12; ++n) {
    std::vector<double> x(n, -1e10);
    EXPECT_TRUE(AllWithin(1e10, x.data(), n));
    for (double& number : x) {
      for (const double bad :
           {std::nextafter(1e10, kHuge), -1.1e10, kHuge, HUGE_VAL, -HUGE_VAL, kNan, -kNan}) {
        number = bad;
        EXPECT_FALSE(AllWithin(1e10, x.data(), n)) << bad << " of " << n;
        EXPECT_EQ(AllFinite(x.data(), n), std::isfinite(bad)) << bad;
      }
      number = 1e10;
    }
  }
}

}  // namespace
}  // namespace robocell
