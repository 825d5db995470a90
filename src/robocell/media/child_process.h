// A child process with a pipe to its stdin or from its stdout, for VideoWriter and VideoReader. Not
// a general process library: no shell, Linux only.
//
// Guarantees: the child gets no other file descriptor of ours; its stderr is collected; it has its
// own process group, so that Ctrl-C in the terminal does not end it before us; writing to a dead
// child never raises SIGPIPE; the destructor kills and reaps, so that no zombie is left. A child
// that makes no progress for `stall_timeout_s` is killed and reported.
//
//   ChildProcess child({"/usr/bin/sort", "-n"}, {.pipe_stdin = true});
//   child.Write(bytes);
//   child.CloseStdin();
//   if (child.Wait() != 0) throw IoError(child.DescribeEnd());
//
// Use it from one thread at a time.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace robocell::internal {

struct ChildProcessOptions {
  bool pipe_stdin = false;   // otherwise stdin is /dev/null
  bool pipe_stdout = false;  // otherwise stdout is /dev/null
  bool warm = false;         // forked from a process that has loaded the program (warm_program.h)
  double stall_timeout_s = 60;
  // "NAME=value": in place of what this process has under the name; not for a warm start.
  std::vector<std::string> environment = {};
};

class ChildProcess {
 public:
  // arguments[0] is the program's path; PATH is not searched. Throws IoError if it cannot be
  // started.
  ChildProcess(const std::vector<std::string>& arguments, const ChildProcessOptions& options);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  // Our end of its stdin, a socket; -1 without one.
  int stdin_descriptor() const { return stdin_; }

  // Writes all bytes to the child's stdin, and blocks while the child is busy. Returns false if the
  // child closed its end or died.
  bool Write(std::span<const uint8_t> bytes);
  void CloseStdin();
  // Fills `bytes` from the child's stdout; fewer bytes than requested mean that its end was
  // reached.
  size_t Read(std::span<uint8_t> bytes);

  // Waits for the end and returns the exit code, or 128 + signal. Later calls return the same.
  int Wait();
  void Kill();

  // Returns the signal that ended it, or 0.
  int signal() const { return signal_; }
  // Returns "exited with code 1", "was killed by signal 9 (Killed)" or "is running".
  std::string DescribeEnd() const;
  // Returns what the child wrote to stderr (the last 2000 characters, trimmed), "" if nothing.
  std::string Errors() const;

 private:
  [[noreturn]] void Stalled(const char* doing);
  bool PollFor(int fd, short events) const;
  bool TryReap();
  void CloseAll();

  std::string program_;
  double stall_timeout_s_;
  pid_t pid_ = -1;
  pid_t owner_ = getpid();  // a fork of it leaves the child alone
  bool reaped_ = false;
  int exit_code_ = 0;
  int signal_ = 0;   // the signal that ended it, or 0
  int stdin_ = -1;   // our end of a socket: MSG_NOSIGNAL keeps SIGPIPE away
  int stdout_ = -1;  // our end of a pipe
  int errors_ = -1;  // a memory file
};

}  // namespace robocell::internal
