#include "robocell/testing/expect_throw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell {

std::string ExpectThrown(void (*call)(void* function), void* function,
                         const std::type_info& expected,
                         bool (*is_expected)(const std::exception& thrown),
                         const std::string& text) {
  try {
    call(function);
  } catch (const std::exception& error) {
    if (!is_expected(error)) {
      ADD_FAILURE() << "another exception was thrown: " << error.what();
      return "";
    }
    EXPECT_TRUE(typeid(error) == expected) << "the exception is of a derived class";
    EXPECT_THAT(error.what(), ::testing::HasSubstr(text));
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown; expected: " << text;
  return "";
}

}  // namespace robocell
