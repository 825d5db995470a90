#include "robocell/base/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

constexpr std::array<std::string_view, 5> kLevelNames = {"debug", "info", "warn", "error", "none"};

std::unique_ptr<spdlog::logger> MakeStderrLogger() {
  auto logger = std::make_unique<spdlog::logger>("robocell",
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_level(spdlog::level::trace);  // the level of SetLogLevel decides
  logger->set_pattern("%H:%M:%S.%e robocell %l: %v");
  logger->flush_on(spdlog::level::trace);
  return logger;
}

struct State {
  std::atomic<LogLevel> level = LogLevel::kInfo;
  std::mutex mutex;                     // guards `sink`; never held while a sink runs
  std::shared_ptr<const LogSink> sink;  // null means stderr
  std::unique_ptr<spdlog::logger> stderr_logger = MakeStderrLogger();
};

// Never destroyed: destructors of static objects may still log.
State& GlobalState() {
  static State* const state = new State;
  return *state;
}

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarn:
      return spdlog::level::warn;
    case LogLevel::kError:
    case LogLevel::kNone:
      break;
  }
  return spdlog::level::err;
}

std::shared_ptr<const LogSink> CurrentSink(State& state) {
  const std::lock_guard lock(state.mutex);
  return state.sink;
}

}  // namespace

std::string_view LogLevelName(LogLevel level) { return kLevelNames.at(static_cast<size_t>(level)); }

LogLevel LogLevelFromName(std::string_view name) {
  for (size_t i = 0; i < kLevelNames.size(); ++i) {
    if (kLevelNames[i] == name) return static_cast<LogLevel>(i);
  }
  throw NotFoundError(NoSuchName("", "log level", name, {kLevelNames.begin(), kLevelNames.end()}));
}

void SetLogLevel(LogLevel level) { GlobalState().level = level; }

LogLevel GetLogLevel() { return GlobalState().level; }

void Log(LogLevel level, std::string_view message) noexcept {
  State& state = GlobalState();
  if (level < state.level.load(std::memory_order_relaxed)) return;
  try {
    if (const auto sink = CurrentSink(state)) {
      (*sink)(level, message);
    } else {
      state.stderr_logger->log(ToSpdlog(level),
                               spdlog::string_view_t(message.data(), message.size()));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "robocell: the log sink failed (%s) on: %.*s\n", error.what(),
                 static_cast<int>(message.size()), message.data());
  } catch (...) {
    std::fprintf(stderr, "robocell: the log sink failed on: %.*s\n",
                 static_cast<int>(message.size()), message.data());
  }
}

void LogDebug(std::string_view message) noexcept { Log(LogLevel::kDebug, message); }
void LogInfo(std::string_view message) noexcept { Log(LogLevel::kInfo, message); }
void LogWarn(std::string_view message) noexcept { Log(LogLevel::kWarn, message); }
void LogError(std::string_view message) noexcept { Log(LogLevel::kError, message); }

LogSink SetLogSink(LogSink sink) {
  State& state = GlobalState();
  std::shared_ptr<const LogSink> next;
  if (sink) next = std::make_shared<const LogSink>(std::move(sink));
  {
    const std::lock_guard lock(state.mutex);
    state.sink.swap(next);
  }
  return next ? *next : LogSink();
}

}  // namespace robocell
