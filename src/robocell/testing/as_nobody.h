// For tests only: returns the exception of a function that a user without rights calls. Tests often
// run as root, to whom no folder is closed.
//
//   EXPECT_THAT(MessageAsNobody([&] { AtomicWrite(closed / "a", ""); }), HasSubstr("Permission"));
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <exception>
#include <string>

namespace robocell {

inline constexpr uid_t kNobody = 65534;

// Runs `function` in a child process as an unprivileged user; returns "nothing was thrown" without
// an exception.
template <class Function>
std::string MessageAsNobody(Function&& function) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::string message = "nothing was thrown";
    if (geteuid() == 0 && setuid(kNobody) != 0) message = "cannot become another user";
    try {
      function();
    } catch (const std::exception& error) {
      message = error.what();
    }
    [[maybe_unused]] const ssize_t written = write(ends[1], message.data(), message.size());
    _exit(0);
  }
  close(ends[1]);
  std::string message(4096, '\0');
  const ssize_t size = read(ends[0], message.data(), message.size());
  message.resize(size > 0 ? static_cast<size_t>(size) : 0);
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return message;
}

}  // namespace robocell
