// Asks a library that may not survive what it is given: the question runs in a child process, and
// a crash there is an answer. For files of strangers; ours were read back by their hash.
//
//   const std::vector<std::string> lines = RunApart([&] { return ProblemsIn(file); });
//
// The child is a fork of this thread alone: the question may open files and allocate, and must not
// touch Python, the engine, GL or other threads.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace robocell {

inline constexpr std::chrono::seconds kMostApart{60};

// The lines that `ask` gives (without line ends), in the child. Error with the text of what it
// threw, or that it crashed. IoError with the system's error when it threw such a one, ran out of
// memory, was killed by others or had not ended after `most`, or no child can be started.
std::vector<std::string> RunApart(const std::function<std::vector<std::string>()>& ask,
                                  std::chrono::seconds most = kMostApart);

}  // namespace robocell
