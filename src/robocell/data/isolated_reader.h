// Runs a library that may crash on its input in a child process: a crash there becomes an error
// here. It is for foreign files; for our own files the hash is compared first.
//
//   IsolatedReader reader([](const std::string& file) { return ProblemsIn(file); });
//   for (const std::string& file : files) Tell(file, reader.Ask(file));
//
// The child is forked from the calling thread for the first query, and again after a query that
// ended it, because the fork of a large process takes tens of milliseconds. It keeps no file of
// this process open. The answering function may open files and allocate; it must not touch Python,
// the engine, GL or other threads.
#pragma once

#include <sys/types.h>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robocell::internal {

inline constexpr std::chrono::seconds kIsolatedTimeout{60};

// Not thread-safe.
class IsolatedReader {
 public:
  // Returns lines without line ends.
  using Answer = std::function<std::vector<std::string>(const std::string& question)>;

  explicit IsolatedReader(Answer answer, std::chrono::seconds most = kIsolatedTimeout);
  ~IsolatedReader();
  IsolatedReader(const IsolatedReader&) = delete;
  IsolatedReader& operator=(const IsolatedReader&) = delete;

  // Returns the child's answer. Throws Error with the text of an exception of the function, or if
  // the child crashed; IoError with the system's error if the function threw one, if the child ran
  // out of memory, was killed or took longer than `most`, and if no child can be started.
  std::vector<std::string> Ask(const std::string& question);

 private:
  enum class Reply { kWhole, kLate, kEnded };

  void Start();
  std::optional<int> End();  // the child's status as of waitpid, if available
  Reply Exchange(std::string_view question, std::string& text) const;

  Answer answer_;
  std::chrono::seconds most_;
  int socket_ = -1;
  pid_t child_ = -1;
};

}  // namespace robocell::internal
