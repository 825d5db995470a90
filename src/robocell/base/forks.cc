#include "robocell/base/forks.h"

#include <pthread.h>

#include <atomic>

namespace robocell::internal {
namespace {

std::atomic<int>& Forks() {
  static std::atomic<int> forks{0};
  return forks;
}

}  // namespace

int ForkCount() {
  static const int handled = pthread_atfork(nullptr, nullptr, [] { ++Forks(); });
  (void)handled;
  return Forks().load(std::memory_order_relaxed);
}

}  // namespace robocell::internal
