// The same work on several threads at once. For the solvers of this folder.
#pragma once

#include <thread>
#include <vector>

namespace robocell {

// Calls work(0 .. threads - 1), number 0 on the caller's thread; returns when all have ended, also
// when number 0 throws. The others must not throw.
template <class Work>
void OnThreads(int threads, const Work& work) {
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back([&work, t] { work(t); });
  work(0);
}

}  // namespace robocell
