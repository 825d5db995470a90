#include "robocell/data/apart.h"

#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <new>

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

// The errno of the IoError; 0 when there is none.
int SystemError(const std::function<std::vector<std::string>()>& ask, const std::string& text) {
  try {
    RunApart(ask, std::chrono::seconds(1));
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), text);
    return error.system_error();
  }
  ADD_FAILURE() << "no IoError";
  return 0;
}

// Nothing that is said of what was read: an overloaded machine, one without memory.
TEST(Apart, WhatDoesNotEndOrIsEndedByOthersIsTheSystems) {
  const auto wait = []() -> std::vector<std::string> {
    pause();
    return {};
  };
  EXPECT_EQ(SystemError(wait, "reading it had not ended after 1 s"), ETIMEDOUT);
  const auto killed = []() -> std::vector<std::string> {
    raise(SIGKILL);
    return {};
  };
  EXPECT_EQ(SystemError(killed, "reading it ends the process (Killed)"), EINTR);
  const auto memory = []() -> std::vector<std::string> { throw std::bad_alloc(); };
  EXPECT_EQ(SystemError(memory, "there is not enough memory to read it"), ENOMEM);
}

}  // namespace
}  // namespace robocell
