#include "robocell/render/gl_backends.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

TEST(GlLibraryTest, AMissingLibraryNamesAllThatWereTried) {
  ExpectThrow<IoError>([] { GlLibrary({"libnone.so.1", "libnone.so"}); }, "libnone.so");
}

TEST(GlLibraryTest, TakesTheFirstLibraryThatIsThere) {
  const GlLibrary library({"libnone.so.1", "libm.so.6"});
  double (*root)(double) = nullptr;
  library.Load(root, "sqrt");
  EXPECT_EQ(root(9), 3);
}

TEST(GlLibraryTest, AMissingFunctionIsAnError) {
  const GlLibrary library({"libm.so.6"});
  EXPECT_NE(library.Symbol("cos"), nullptr);
  ExpectThrow<IoError>([&] { library.Symbol("no_such_function"); }, "no_such_function");
}

}  // namespace
}  // namespace robocell::internal
