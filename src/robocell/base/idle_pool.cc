#include "robocell/base/idle_pool.h"

#include <pthread.h>

#include <algorithm>
#include <vector>

namespace robocell::internal {

namespace {

struct Pools {
  std::mutex mutex;
  std::vector<ForkSafePool*> all;
};

// Never destroyed: pools of other files may be destroyed later, and threads may fork even then.
Pools& TheirPools() {
  static Pools* const pools = new Pools;
  return *pools;
}

}  // namespace

void EmptyBeforeFork() {
  TheirPools().mutex.lock();
  for (ForkSafePool* pool : TheirPools().all) pool->DropIdle();
}

namespace {

void GoOnAfterFork() { TheirPools().mutex.unlock(); }

void HandleForks() {
  static const int handled = pthread_atfork(EmptyBeforeFork, GoOnAfterFork, GoOnAfterFork);
  (void)handled;
}

}  // namespace

ForkSafePool::ForkSafePool() {
  HandleForks();
  const std::lock_guard lock(Mutex());
  TheirPools().all.push_back(this);
}

void ForkSafePool::Leave() {
  const std::lock_guard lock(Mutex());
  std::erase(TheirPools().all, this);
}

std::mutex& ForkSafePool::Mutex() { return TheirPools().mutex; }

}  // namespace robocell::internal
