// For tests only: expects an exception of a type whose message contains a text.
//
//   ExpectThrow<NotFoundError>([&] { scene.robot("lft"); }, "Did you mean 'left'?");
#pragma once

#include <exception>
#include <string>
#include <typeinfo>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell {

// Returns the message, so that more can be asked of it; "" when nothing of that type was thrown.
template <typename Exception, typename Function>
std::string ExpectThrow(Function&& function, const std::string& text) {
  try {
    function();
  } catch (const Exception& error) {
    EXPECT_TRUE(typeid(error) == typeid(Exception)) << "the exception is of a derived class";
    EXPECT_THAT(error.what(), ::testing::HasSubstr(text));
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception was thrown: " << error.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown; expected: " << text;
  return "";
}

}  // namespace robocell
