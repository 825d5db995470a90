// Logging: one process-wide level and one replaceable sink, shared by all layers.
//
// The log is not for data: results of a run belong in its episodes and reports.
//
//   LogWarn(fmt::format("robot '{}': actuator '{}' has no limits", robot, actuator));
//   const auto keep = [&](LogLevel, std::string_view text) { lines.emplace_back(text); };
//   const ScopedLogSink capture(keep);
//
// All functions may be called from any thread, also from a sink. They never throw.
#pragma once

#include <functional>
#include <string_view>

namespace robocell {

// kNone is for SetLogLevel only: no message has this level.
enum class LogLevel { kDebug = 0, kInfo = 1, kWarn = 2, kError = 3, kNone = 4 };

// Returns "debug", "info", "warn", "error", "none".
std::string_view LogLevelName(LogLevel level);
// Returns the level of that name. Throws NotFoundError that lists the names.
LogLevel LogLevelFromName(std::string_view name);

// Messages below this level are dropped, all of them below kNone. The default is kInfo.
void SetLogLevel(LogLevel level);
LogLevel GetLogLevel();

void Log(LogLevel level, std::string_view message) noexcept;
void LogDebug(std::string_view message) noexcept;
void LogInfo(std::string_view message) noexcept;
void LogWarn(std::string_view message) noexcept;
void LogError(std::string_view message) noexcept;

// Receives each message that passes the level, on the thread that logs and with no lock held:
// several threads may call it at once, it may itself log, and it may wait for Python's interpreter
// lock. Its exceptions are written to stderr and end there.
using LogSink = std::function<void(LogLevel, std::string_view)>;

// Replaces the sink and returns the previous one; an empty sink means stderr, which is the default.
// Another thread may still be inside the old sink when this returns.
LogSink SetLogSink(LogSink sink);

// Replaces the sink for a scope and restores the former one at its end.
class ScopedLogSink {
 public:
  explicit ScopedLogSink(LogSink sink) : former_(SetLogSink(std::move(sink))) {}
  ~ScopedLogSink() { SetLogSink(std::move(former_)); }
  ScopedLogSink(const ScopedLogSink&) = delete;
  ScopedLogSink& operator=(const ScopedLogSink&) = delete;

 private:
  LogSink former_;
};

}  // namespace robocell
