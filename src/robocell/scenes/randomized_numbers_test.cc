#include "robocell/scenes/randomized_numbers.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(RandomizedNumbers, RejectsOtherCountsWordsAndWhatIsNotFinite) {
  EXPECT_EQ(NumberOf(RandomizedValue{.numbers = {0.5}}, "a"), 0.5);
  EXPECT_EQ(NumbersOf({.numbers = {1, 2, 3}}, 3, "a").back(), 3);
  EXPECT_EQ(NumberOf(RandomizedValues{}, "a", 7), 7);
  ExpectThrow<ArgumentError>(
      [] {
        NumberOf(RandomizedValue{.numbers = {1, 2}}, "a/mass");
      },
      "'a/mass' must be a number");
  ExpectThrow<ArgumentError>([] { NumberOf(RandomizedValue{.word = "wood"}, "a"); }, "a number");
  ExpectThrow<ArgumentError>(
      [] {
        NumbersOf({.numbers = {1, 0.0 / 0.0, 3}}, 3, "a");
      },
      "red, green and blue");
}

}  // namespace
}  // namespace robocell::internal
