#include "robocell/mujoco/guard.h"

#include <mujoco/mujoco.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/version.h"

// The engine's thread-local handler, which its documentation describes (programming/simulation,
// "Error recovery") but no public header declares. Weak: without it the process-wide handler still
// serves every guard that is not inside another library's.
// NOLINTNEXTLINE(clang-diagnostic-reserved-identifier): the engine's name
extern "C" __attribute__((weak)) mjfLogHandler _mjPRIVATE_setTlsLogHandler(mjfLogHandler handler);

namespace robocell::internal {
namespace {

struct ThreadTop;
struct Frame {
  std::jmp_buf environment;
  ThreadTop* top;
  Frame* outer;
  mjfLogHandler outer_handler;
  char* text;
  mjData* data;
  size_t pstack, pbase;
};

// Looked up once in a guard: in a shared library each access is a call.
struct ThreadTop {
  Frame* frame = nullptr;
  WarningCapture* capture = nullptr;
};
thread_local ThreadTop thread_top;
mjfLogHandler previous_handler = nullptr;

bool IsWanted(const mjLogMessage& message) {
  if (message.level != mjLOG_INFO || message.topic == mjTOPIC_NONE) return true;
  return mju_getLogConfig().topics & (1 << (message.topic - 1));
}

std::string Text(const mjLogMessage& message) {
  std::string text = message.subject;
  if (message.body && *message.body) text += std::string("\n") + message.body;
  return text;
}

void ForwardToLog(const mjLogMessage& message) {
  if (message.level == mjLOG_WARNING && thread_top.capture) {
    thread_top.capture->Add(Text(message));
  } else if (message.level == mjLOG_WARNING) {
    LogWarn("MuJoCo: " + Text(message));
  } else if (IsWanted(message)) {
    message.level == mjLOG_DEBUG ? LogDebug("MuJoCo: " + Text(message))
                                 : LogInfo("MuJoCo: " + Text(message));
  }
}

// Copies without allocating: the jump that follows would leak.
[[noreturn]] void JumpBack(const mjLogMessage& message) {
  Frame* frame = thread_top.frame;
  const char* body = message.body && *message.body ? message.body : nullptr;
  std::snprintf(frame->text, guard::kTextSize, "%s%s%s", message.subject, body ? "\n" : "",
                body ? body : "");
  std::longjmp(frame->environment, 1);
}

void OnMessage(const mjLogMessage* message) {
  if (message->level != mjLOG_ERROR) {
    try {
      ForwardToLog(*message);
    } catch (...) {  // no exception may enter the engine
    }
    return;
  }
  if (thread_top.frame) JumpBack(*message);
  // Not ours: the previous handler decides (the engine's default prints and ends the process).
  if (previous_handler) previous_handler(message);
  std::abort();
}

bool Install() {
  RequireEngineVersion();
  mjLogConfig config = mju_getLogConfig();
  config.logto_file = 0;
  mju_setLogConfig(config);
  previous_handler = mju_setLogHandler(&OnMessage);
  return true;
}

mjfLogHandler SetThreadHandler(mjfLogHandler handler) {
  return _mjPRIVATE_setTlsLogHandler ? _mjPRIVATE_setTlsLogHandler(handler) : nullptr;
}

void Leave(const Frame& frame) {
  frame.top->frame = frame.outer;
  SetThreadHandler(frame.outer_handler);
}

}  // namespace

namespace guard {

bool Run(void (*call)(void*), void* argument, mjData* data, char* text) {
  static const bool installed = Install();
  (void)installed;
  // Everything is stored before setjmp: later changes would be indeterminate after the jump.
  Frame frame;
  frame.top = &thread_top;
  frame.outer = frame.top->frame;
  frame.text = text;
  frame.data = data;
  frame.pstack = data ? data->pstack : 0;
  frame.pbase = data ? data->pbase : 0;
  frame.outer_handler = SetThreadHandler(&OnMessage);
  frame.top->frame = &frame;
  if (setjmp(frame.environment) == 0) {
    call(argument);
    Leave(frame);
    return true;
  }
  Leave(frame);
  if (frame.data) {
    frame.data->pstack = frame.pstack;
    frame.data->pbase = frame.pbase;
  }
  return false;
}

void Throw(std::string_view context, const char* text) {
  throw EngineError(std::string(context) + (context.empty() ? "" : ": ") + text);
}

}  // namespace guard

WarningCapture::WarningCapture() : outer_(thread_top.capture) { thread_top.capture = this; }

WarningCapture::~WarningCapture() { thread_top.capture = outer_; }

}  // namespace robocell::internal
