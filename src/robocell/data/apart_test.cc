#include "robocell/data/apart.h"

#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Apart, GivesTheLinesOfAChild) {
  const pid_t here = getpid();
  bool changed = false;
  EXPECT_THAT(RunApart([&] {
                changed = true;
                return std::vector<std::string>{getpid() == here ? "here" : "elsewhere", "two"};
              }),
              ElementsAre("elsewhere", "two"));
  EXPECT_FALSE(changed) << "memory is not shared";
  EXPECT_THAT(RunApart([] { return std::vector<std::string>(); }), IsEmpty());
}

TEST(Apart, LongAnswersComeWhole) {
  const std::string line(1 << 20, 'x');
  EXPECT_THAT(RunApart([&] {
                return std::vector<std::string>{line, line};
              }),
              ElementsAre(line, line));
}

TEST(Apart, WhatIsThrownThereIsThrownHere) {
  ExpectThrow<Error>([] { RunApart([]() -> std::vector<std::string> { throw Error("no rows"); }); },
                     "no rows");
  try {
    RunApart([]() -> std::vector<std::string> { throw IoError("cannot read", EACCES); });
    FAIL() << "nothing was thrown";
  } catch (const IoError& error) {
    EXPECT_EQ(error.system_error(), EACCES);
    EXPECT_STREQ(error.what(), "cannot read");
  }
}

TEST(Apart, ACrashIsAnAnswer) {
  const auto crash = []() -> std::vector<std::string> {
    std::signal(SIGSEGV, SIG_DFL);  // sanitizers take it otherwise
    raise(SIGSEGV);
    return {};
  };
  ExpectThrow<Error>([&] { RunApart(crash); }, "reading it ends the process (Segmentation fault)");
}

TEST(Apart, WhatDoesNotEndIsEnded) {
  const auto wait = []() -> std::vector<std::string> {
    pause();
    return {};
  };
  ExpectThrow<Error>([&] { RunApart(wait, std::chrono::seconds(1)); }, "had not ended after 1 s");
}

}  // namespace
}  // namespace robocell
