#include "robocell/rollout/expert_calls.h"

#include <mutex>
#include <set>

#include "robocell/base/log.h"

namespace robocell::internal {
namespace {

// Logs the calls that led to an error once: a policy often fails alike in each rollout.
void LogPolicyError(const std::string& reason, const std::string& trace) {
  static std::mutex mutex;
  static std::set<std::string> logged;
  const std::scoped_lock lock(mutex);
  const bool is_new = logged.insert(reason).second;
  LogWarn(is_new && !trace.empty() ? reason + "\n" + trace : reason);
}

}  // namespace

std::string PolicyError(const HookError& error) {
  return std::string("policy error: ") + error.what();
}

std::string ExpertCalls::failure() {
  const std::string given = (*this)("failure", std::string(), [&] { return expert_.failure(); });
  return error_.empty() ? given : error_;
}

void ExpertCalls::Keep(const HookError& error) {
  error_ = PolicyError(error);
  LogPolicyError(error_, error.trace());
}

}  // namespace robocell::internal
