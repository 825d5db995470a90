// Skipping a test that needs something this machine lacks. For tests only.
//
// A developer without it sees "skipped" with the reason. With CI=true the same test fails, so that
// nothing goes untested for months because a machine lost a package.
//
//   TEST(Camera, RendersOnOsMesa) {
//     if (!OsMesaIsThere()) SKIP_OR_FAIL("libosmesa6 is not installed");
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string_view>

namespace robocell {

// Returns true if a skipped test counts as a failure: the environment variable CI is "true" or "1".
inline bool SkipsAreFailures() {
  const char* ci = std::getenv("CI");
  return ci != nullptr && (std::string_view(ci) == "true" || std::string_view(ci) == "1");
}

}  // namespace robocell

// Ends the running test (a function returning void) as skipped, or as failed with CI=true.
#define SKIP_OR_FAIL(reason)                                                          \
  do {                                                                                \
    if (::robocell::SkipsAreFailures()) FAIL() << (reason) << " (CI allows no skip)"; \
    GTEST_SKIP() << (reason);                                                         \
  } while (false)
