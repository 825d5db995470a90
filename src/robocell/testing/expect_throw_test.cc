#include "robocell/testing/expect_throw.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace robocell {
namespace {

void Refuse() { throw std::invalid_argument("joint 'lft' is unknown"); }

TEST(ExpectThrow, ReturnsTheMessageOfTheExpectedException) {
  const auto refuse = [] { Refuse(); };
  EXPECT_EQ(ExpectThrow<std::invalid_argument>(refuse, "'lft'"), "joint 'lft' is unknown");
  EXPECT_EQ(ExpectThrow<std::invalid_argument>(&Refuse, ""), "joint 'lft' is unknown");
}

TEST(ExpectThrow, FailsWithAnotherText) {
  EXPECT_NONFATAL_FAILURE(ExpectThrow<std::invalid_argument>([] { Refuse(); }, "'right'"),
                          "has substring \"'right'\"");
}

TEST(ExpectThrow, FailsWithAnotherType) {
  EXPECT_NONFATAL_FAILURE(ExpectThrow<std::runtime_error>([] { Refuse(); }, ""),
                          "another exception was thrown: joint 'lft' is unknown");
  EXPECT_NONFATAL_FAILURE(ExpectThrow<std::logic_error>([] { Refuse(); }, ""), "derived class");
}

TEST(ExpectThrow, FailsWhenNothingIsThrown) {
  EXPECT_NONFATAL_FAILURE(ExpectThrow<std::logic_error>([] {}, "unknown"),
                          "nothing was thrown; expected: unknown");
}

}  // namespace
}  // namespace robocell
