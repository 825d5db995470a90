// Asks a library that may not survive what it is given: the questions are answered by a child
// process, and a crash there is an answer. For files of strangers; ours were read back by their
// hash.
//
//   ApartReader reader([](const std::string& file) { return ProblemsIn(file); });
//   for (const std::string& file : files) Tell(file, reader.Ask(file));
//
// The child is a fork of the asking thread alone, made for the first question and again after one
// that ended it: a fork of a large process takes tens of milliseconds. It keeps nothing of this
// process open. What answers may open files and allocate, and must not touch Python, the engine, GL
// or other threads.
#pragma once

#include <sys/types.h>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robocell {

inline constexpr std::chrono::seconds kMostApart{60};

// One thread at a time.
class ApartReader {
 public:
  // Lines, without line ends.
  using Answer = std::function<std::vector<std::string>(const std::string& question)>;

  explicit ApartReader(Answer answer, std::chrono::seconds most = kMostApart);
  ~ApartReader();
  ApartReader(const ApartReader&) = delete;
  ApartReader& operator=(const ApartReader&) = delete;

  // What the child answers. Error with the text of what it threw, or that it crashed. IoError with
  // the system's error when it threw such a one, ran out of memory, was killed by others or had not
  // ended after `most`, or no child can be started.
  std::vector<std::string> Ask(const std::string& question);

 private:
  enum class Reply { kWhole, kLate, kEnded };

  void Start();
  std::optional<int> End();  // the child's status as of waitpid, where that tells
  Reply Exchange(std::string_view question, std::string& text) const;

  Answer answer_;
  std::chrono::seconds most_;
  int socket_ = -1;
  pid_t child_ = -1;
};

}  // namespace robocell
