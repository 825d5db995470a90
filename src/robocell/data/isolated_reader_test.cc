#include "robocell/data/isolated_reader.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Lines = std::vector<std::string>;

TEST(IsolatedReader, ReturnsTheLinesOfTheChild) {
  const pid_t here = getpid();
  bool changed = false;
  IsolatedReader reader([&](const std::string& question) {
    changed = true;
    return Lines{getpid() == here ? "here" : "elsewhere", question};
  });
  EXPECT_THAT(reader.Ask("two"), ElementsAre("elsewhere", "two"));
  EXPECT_FALSE(changed) << "memory is not shared";
  EXPECT_THAT(IsolatedReader([](const std::string&) { return Lines(); }).Ask(""), IsEmpty());
}

TEST(IsolatedReader, OneChildServesManyQueries) {
  int count = 0;
  IsolatedReader reader([&](const std::string&) { return Lines{std::to_string(++count)}; });
  EXPECT_THAT(reader.Ask(""), ElementsAre("1"));
  EXPECT_THAT(reader.Ask(""), ElementsAre("2"));
}

TEST(IsolatedReader, TransfersLongQueriesAndResults) {
  const std::string line(1 << 20, 'x');
  IsolatedReader reader([](const std::string& question) { return Lines{question, question}; });
  EXPECT_THAT(reader.Ask(line), ElementsAre(line, line));
}

TEST(IsolatedReader, RethrowsExceptionsOfTheChild) {
  IsolatedReader reader([](const std::string& question) -> Lines {
    if (question == "closed") throw IoError("cannot read", EACCES);
    if (question == "empty") throw Error("no rows");
    return {};
  });
  ExpectThrow<Error>([&] { reader.Ask("empty"); }, "no rows");
  try {
    reader.Ask("closed");
    FAIL() << "nothing was thrown";
  } catch (const IoError& error) {
    EXPECT_EQ(error.system_error(), EACCES);
    EXPECT_STREQ(error.what(), "cannot read");
  }
  EXPECT_THAT(reader.Ask("whole"), IsEmpty());
}

void Crash() {
  std::signal(SIGSEGV, SIG_DFL);  // sanitizers handle it otherwise
  raise(SIGSEGV);
}

TEST(IsolatedReader, ReportsACrashAndServesTheNextQuery) {
  IsolatedReader reader([](const std::string& question) {
    if (question == "bad") Crash();
    return Lines{question};
  });
  EXPECT_THAT(reader.Ask("good"), ElementsAre("good"));
  ExpectThrow<Error>([&] { reader.Ask("bad"); },
                     "reading it ends the process (Segmentation fault)");
  EXPECT_THAT(reader.Ask("good"), ElementsAre("good"));
}

TEST(IsolatedReader, ReplacesABrokenChild) {
  bool broken = false;
  IsolatedReader reader([&](const std::string& question) {
    if (broken) Crash();
    broken = question == "sly";  // it crashes at the next input
    return Lines{question};
  });
  EXPECT_THAT(reader.Ask("sly"), ElementsAre("sly"));
  EXPECT_THAT(reader.Ask("good"), ElementsAre("good"));
}

TEST(IsolatedReader, KeepsNoInheritedDescriptorsOpen) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  IsolatedReader reader([](const std::string& question) { return Lines{question}; });
  EXPECT_THAT(reader.Ask("here"), ElementsAre("here"));
  close(ends[1]);
  pollfd ended{.fd = ends[0], .events = POLLIN, .revents = 0};
  EXPECT_EQ(poll(&ended, 1, 5000), 1) << "the child has the other end";
  EXPECT_TRUE(ended.revents & POLLHUP);
  close(ends[0]);
  EXPECT_THAT(reader.Ask("still"), ElementsAre("still"));
}

TEST(IsolatedReader, ReportsAnUnknownEndIfSigchldIsIgnored) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  IsolatedReader reader([](const std::string&) -> Lines {
    Crash();
    return {};
  });
  ExpectThrow<IoError>([&] { reader.Ask(""); },
                       "reading it ends the process for an unknown reason");
  std::signal(SIGCHLD, before);
}

// Returns the errno of the IoError; 0 if there is none.
int SystemError(const std::function<void()>& end, const std::string& text,
                std::chrono::seconds timeout = std::chrono::seconds(60)) {
  IsolatedReader reader(
      [&](const std::string&) {
        end();
        return Lines();
      },
      timeout);
  try {
    reader.Ask("");
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), text);
    return error.system_error();
  }
  ADD_FAILURE() << "no IoError";
  return 0;
}

// Such an end says nothing about the input: an overloaded machine, or one without memory.
TEST(IsolatedReader, ReportsTimeoutsAndKillsAsSystemErrors) {
  EXPECT_EQ(
      SystemError([] { pause(); }, "reading it had not ended after 1 s", std::chrono::seconds(1)),
      ETIMEDOUT);
  EXPECT_EQ(SystemError([] { raise(SIGKILL); }, "reading it ends the process (Killed)"), EINTR);
  EXPECT_EQ(SystemError([] { throw std::bad_alloc(); }, "there is not enough memory to read it"),
            ENOMEM);
}

}  // namespace
}  // namespace robocell::internal
