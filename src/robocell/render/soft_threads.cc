#include "robocell/render/soft_threads.h"

#include <thread>

namespace robocell::internal {
namespace {

constexpr int kMost = 256;

}  // namespace

SoftThreads::SoftThreads(int count) {
  if (count != 1) workers_ = std::make_unique<WorkerThreads>(count, kMost);
  scratches_.resize(workers_ ? static_cast<size_t>(workers_->count()) : 1);
}

}  // namespace robocell::internal
