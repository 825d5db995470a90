#include "robocell/base/log.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::GetCapturedStderr;

class LogTest : public ::testing::Test {
 protected:
  void TearDown() override {
    SetLogLevel(LogLevel::kInfo);
    SetLogSink(nullptr);
  }
  LogSink Collect() {
    return [this](LogLevel level, std::string_view text) {
      lines_.push_back(std::string(LogLevelName(level)) + " " + std::string(text));
    };
  }

  std::vector<std::string> lines_;
};

TEST_F(LogTest, InfoIsTheDefaultLevel) { EXPECT_EQ(GetLogLevel(), LogLevel::kInfo); }

TEST_F(LogTest, MessagesBelowTheLevelAreDropped) {
  SetLogSink(Collect());
  SetLogLevel(LogLevel::kWarn);
  LogDebug("a");
  LogInfo("b");
  LogWarn("c");
  LogError("d");
  EXPECT_THAT(lines_, ElementsAre("warn c", "error d"));
  SetLogLevel(LogLevel::kDebug);
  LogDebug("e");
  LogInfo("f");
  EXPECT_THAT(lines_, ElementsAre("warn c", "error d", "debug e", "info f"));
}

TEST_F(LogTest, StderrIsTheDefaultSink) {
  CaptureStderr();
  LogWarn("the message {} %s");
  EXPECT_THAT(GetCapturedStderr(), HasSubstr(" robocell warning: the message {} %s\n"));
}

TEST_F(LogTest, AScopedSinkRestoresThePreviousOne) {
  SetLogSink(Collect());
  {
    std::vector<std::string> inner;
    const ScopedLogSink capture([&](LogLevel, std::string_view text) { inner.emplace_back(text); });
    LogInfo("inside");
    EXPECT_THAT(inner, ElementsAre("inside"));
  }
  LogInfo("outside");
  EXPECT_THAT(lines_, ElementsAre("info outside"));
}

TEST_F(LogTest, ASinkCanLogAndReplaceItself) {
  SetLogSink([this](LogLevel, std::string_view) {
    SetLogSink(Collect());
    LogInfo("from the sink");
  });
  LogInfo("first");
  LogInfo("second");
  EXPECT_THAT(lines_, ElementsAre("info from the sink", "info second"));
}

TEST_F(LogTest, AFailingSinkIsReportedWithoutAnException) {
  SetLogSink([](LogLevel, std::string_view) { throw std::runtime_error("no space"); });
  CaptureStderr();
  LogInfo("lost words");
  EXPECT_EQ(GetCapturedStderr(), "robocell: the log sink failed (no space) on: lost words\n");
  SetLogSink([](LogLevel, std::string_view) { throw 1; });
  CaptureStderr();
  LogInfo("lost words");
  EXPECT_EQ(GetCapturedStderr(), "robocell: the log sink failed on: lost words\n");
}

TEST_F(LogTest, ManyThreadsLogWhileTheSinkIsReplaced) {
  std::atomic<int> count = 0;
  const LogSink sink = [&](LogLevel, std::string_view) { ++count; };
  SetLogSink(sink);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      for (int i = 0; i < 1000; ++i) LogInfo("x");
    });
  }
  for (int i = 0; i < 1000; ++i) SetLogSink(sink);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(count, 4000);
}

TEST_F(LogTest, NoneIsSilent) {
  SetLogSink(Collect());
  SetLogLevel(LogLevel::kNone);
  LogError("not heard");
  SetLogLevel(LogLevel::kError);
  LogError("heard");
  EXPECT_THAT(lines_, ElementsAre("error heard"));
}

TEST_F(LogTest, LevelsHaveNames) {
  for (const LogLevel level :
       {LogLevel::kDebug, LogLevel::kInfo, LogLevel::kWarn, LogLevel::kError, LogLevel::kNone}) {
    EXPECT_EQ(LogLevelFromName(LogLevelName(level)), level);
  }
  ExpectThrow<NotFoundError>(
      [] { LogLevelFromName("warning"); },
      "no log level 'warning'. Known log levels: debug, info, warn, error, none. "
      "Did you mean 'warn'?");
}

}  // namespace
}  // namespace robocell
