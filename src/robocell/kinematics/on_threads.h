// Runs the same work on several threads at once. For the solvers of this folder.
#pragma once

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace robocell::internal {

// Calls work(0 .. threads - 1), number 0 on the caller's thread; returns when all have ended.
// Rethrows the first of their exceptions: `work` makes the others end early.
template <class Work>
void OnThreads(int threads, const Work& work) {
  if (threads <= 1) return work(0);
  std::vector<std::exception_ptr> thrown(static_cast<size_t>(threads));
  const auto guarded = [&](int t) {
    try {
      work(t);
    } catch (...) {
      thrown[static_cast<size_t>(t)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(guarded, t);
    guarded(0);
  }
  const auto first = std::find_if(thrown.begin(), thrown.end(), [](const auto& e) { return !!e; });
  if (first != thrown.end()) std::rethrow_exception(*first);
}

}  // namespace robocell::internal
