#include "robocell/base/ratio.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

TEST(Ratio, OfADecimalIsItsFraction) {
  EXPECT_EQ(RatioOf(0.002), (Ratio{1, 500}));
  EXPECT_EQ(RatioOf(66), (Ratio{66, 1}));
  EXPECT_EQ(RatioOf(29.97), (Ratio{2997, 100}));
  EXPECT_EQ(RatioOf(0.020833), (Ratio{20833, 1000000}));
}

TEST(Ratio, OfAQuotientIsTheQuotient) {
  for (int64_t den = 1; den < 3000; ++den) {
    for (const int64_t num : {1, 7, 1000, 30000}) {
      const Ratio found = RatioOf(static_cast<double>(num) / static_cast<double>(den));
      ASSERT_EQ(found.num * den, num * found.den) << num << "/" << den;
    }
  }
}

TEST(Ratio, HasNoDriftInArithmetic) {
  const Ratio step = RatioOf(1.0 / 480);
  EXPECT_EQ((step * 16).inverse(), (Ratio{30, 1}));
  EXPECT_EQ((step * 16).Text(), "1/30");
  EXPECT_EQ((RatioOf(2) / 1000 * 33).inverse().Text(), "500/33");
  EXPECT_EQ(step.value(), 1.0 / 480);
}

TEST(Ratio, RejectsNonPositiveNumbers) {
  EXPECT_THROW(RatioOf(0), ArgumentError);
  EXPECT_THROW(RatioOf(-1), ArgumentError);
}

TEST(TimesIn, TakesSixDigits) {
  EXPECT_EQ(TimesIn(66, 2), 33);
  EXPECT_EQ(TimesIn(33.33333, 1000.0 / 480), 16);
  EXPECT_EQ(TimesIn(33.33, 1000.0 / 480), 0);
  EXPECT_EQ(TimesIn(1, 2), 0);
  EXPECT_EQ(TimesIn(0, 2), 0);
}

}  // namespace
}  // namespace robocell
