#include "robocell/media/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/media/warm_program.h"

namespace robocell::internal {
namespace {

using Clock = std::chrono::steady_clock;

void CloseFd(int& fd) {
  if (fd >= 0) close(fd);
  fd = -1;
}

// Moves a descriptor out of 0..2, which the child's own redirections use. Takes ownership of `fd`.
int AwayFromStdio(int fd) {
  if (fd < 0 || fd > 2) return fd;
  const int moved = fcntl(fd, F_DUPFD_CLOEXEC, 3);
  close(fd);
  return moved;
}

// Resources of the spawn calls, released on every exit.
struct SpawnSetup {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  int child_stdin = -1;
  int child_stdout = -1;

  SpawnSetup() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    CloseFd(child_stdin);
    CloseFd(child_stdout);
  }
};

// Gives the child a clean start: no blocked signals, default handlers, own process group, only
// descriptors 0, 1 and 2.
void SetDefaults(SpawnSetup& setup) {
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&setup.attributes, &none);
  posix_spawnattr_setsigdefault(&setup.attributes, &all);
  posix_spawnattr_setpgroup(&setup.attributes, 0);
  posix_spawnattr_setflags(&setup.attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
}

void Redirect(SpawnSetup& setup, int errors) {
  auto* actions = &setup.actions;
  if (setup.child_stdin >= 0) {
    posix_spawn_file_actions_adddup2(actions, setup.child_stdin, 0);
  } else {
    posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
  }
  if (setup.child_stdout >= 0) {
    posix_spawn_file_actions_adddup2(actions, setup.child_stdout, 1);
  } else {
    posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_WRONLY, 0);
  }
  posix_spawn_file_actions_adddup2(actions, errors, 2);
  posix_spawn_file_actions_addclosefrom_np(actions, 3);
}

std::vector<char*> Argv(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  return argv;
}

// The environment of this process with other values for some names.
std::vector<std::string> EnvironmentWith(const std::vector<std::string>& changes) {
  std::vector<std::string> all = changes;
  const auto is_changed = [&](const std::string& variable) {
    const std::string beginning = variable.substr(0, variable.find('=') + 1);
    return std::any_of(changes.begin(), changes.end(),
                       [&](const std::string& change) { return change.starts_with(beginning); });
  };
  for (char** variable = environ; *variable; ++variable) {
    if (!is_changed(*variable)) all.emplace_back(*variable);
  }
  return all;
}

// A process that has loaded the program forks the child; -1 when there can be none.
pid_t StartFromLoaded(const std::vector<std::string>& arguments, const SpawnSetup& setup,
                      int errors) {
  int nothing = AwayFromStdio(open("/dev/null", O_RDWR | O_CLOEXEC));
  if (nothing < 0) return -1;
  const pid_t child =
      StartWarm(arguments, {.in = setup.child_stdin >= 0 ? setup.child_stdin : nothing,
                            .out = setup.child_stdout >= 0 ? setup.child_stdout : nothing,
                            .errors = errors});
  CloseFd(nothing);
  return child;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments,
                           const ChildProcessOptions& options)
    : stall_timeout_s_(options.stall_timeout_s) {
  if (arguments.empty()) throw ArgumentError("a child process needs a program");
  program_ = arguments[0];
  auto fail = [&](int error) {
    CloseAll();
    throw IoError(fmt::format("cannot start '{}': {}", program_, std::strerror(error)));
  };
  SpawnSetup setup;
  errors_ = AwayFromStdio(memfd_create("stderr", MFD_CLOEXEC));
  if (errors_ < 0) fail(errno);
  if (options.pipe_stdin) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail(errno);
    stdin_ = AwayFromStdio(ends[0]);
    setup.child_stdin = AwayFromStdio(ends[1]);
    if (stdin_ < 0 || setup.child_stdin < 0) fail(errno);
  }
  if (options.pipe_stdout) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail(errno);
    stdout_ = AwayFromStdio(ends[0]);
    setup.child_stdout = AwayFromStdio(ends[1]);
    if (stdout_ < 0 || setup.child_stdout < 0) fail(errno);
  }
  if (options.warm) pid_ = StartFromLoaded(arguments, setup, errors_);
  if (pid_ > 0) return;
  SetDefaults(setup);
  Redirect(setup, errors_);
  const std::vector<std::string> environment = EnvironmentWith(options.environment);
  const int error = posix_spawn(&pid_, program_.c_str(), &setup.actions, &setup.attributes,
                                Argv(arguments).data(), Argv(environment).data());
  if (error != 0) {
    reaped_ = true;
    fail(error);
  }
}

ChildProcess::~ChildProcess() {
  Kill();
  CloseAll();
}

void ChildProcess::CloseAll() {
  CloseFd(stdin_);
  CloseFd(stdout_);
  CloseFd(errors_);
}

bool ChildProcess::PollFor(int fd, short events) const {
  const auto deadline = Clock::now() + std::chrono::duration<double>(stall_timeout_s_);
  for (;;) {
    const double left_ms =
        std::chrono::duration<double, std::milli>(deadline - Clock::now()).count();
    if (left_ms <= 0) return false;
    pollfd entry{fd, events, 0};
    const int ready = poll(&entry, 1, static_cast<int>(std::min(std::ceil(left_ms), 1e9)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return true;  // the following send or read reports it
  }
}

void ChildProcess::Stalled(const char* doing) {
  Kill();
  throw IoError(fmt::format("'{}' made no progress for {} s while we were {}; it was stopped. {}",
                            program_, stall_timeout_s_, doing, Errors()));
}

bool ChildProcess::Write(std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    if (stdin_ < 0) return false;
    const ssize_t sent = send(stdin_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      bytes = bytes.subspan(static_cast<size_t>(sent));
    } else if (errno == EAGAIN) {
      if (!PollFor(stdin_, POLLOUT)) Stalled("writing to it");
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

void ChildProcess::CloseStdin() {
  // Closing alone is not enough: a process forked meanwhile may have a copy, and the child would
  // wait for it.
  if (stdin_ >= 0) shutdown(stdin_, SHUT_WR);
  CloseFd(stdin_);
}

size_t ChildProcess::Read(std::span<uint8_t> bytes) {
  size_t done = 0;
  while (done < bytes.size() && stdout_ >= 0) {
    if (!PollFor(stdout_, POLLIN)) Stalled("reading from it");
    const ssize_t got = read(stdout_, bytes.data() + done, bytes.size() - done);
    if (got > 0) {
      done += static_cast<size_t>(got);
    } else if (got == 0 || errno != EINTR) {
      break;
    }
  }
  return done;
}

bool ChildProcess::TryReap() {
  if (reaped_) return true;
  int status = 0;
  const pid_t ended = owner_ == getpid() ? waitpid(pid_, &status, WNOHANG) : -1;
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  reaped_ = true;
  if (ended < 0) {
    exit_code_ = -1;  // ECHILD: other code in this process took the status; or this is a fork
  } else {
    signal_ = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    exit_code_ = signal_ != 0 ? 128 + signal_ : WEXITSTATUS(status);
  }
  return true;
}

int ChildProcess::Wait() {
  const auto deadline = Clock::now() + std::chrono::duration<double>(stall_timeout_s_);
  auto pause = std::chrono::microseconds(100);
  while (!TryReap()) {
    if (Clock::now() > deadline) Stalled("waiting for its end");
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::microseconds(2000));
  }
  return exit_code_;
}

void ChildProcess::Kill() {
  if (TryReap()) return;
  kill(pid_, SIGKILL);
  while (!TryReap()) std::this_thread::sleep_for(std::chrono::microseconds(100));
}

std::string ChildProcess::DescribeEnd() const {
  if (!reaped_) return "is running";
  if (exit_code_ < 0) return "ended, but its exit status was taken by other code of this process";
  if (signal_ == 0) return fmt::format("exited with code {}", exit_code_);
  return fmt::format("was killed by signal {} ({})", signal_, strsignal(signal_));
}

std::string ChildProcess::Errors() const {
  constexpr off_t kMost = 2000;
  struct stat file;
  if (fstat(errors_, &file) != 0 || file.st_size == 0) return "";
  const off_t size = file.st_size;
  std::string text(static_cast<size_t>(std::min(size, kMost)), '\0');
  const ssize_t got =
      pread(errors_, text.data(), text.size(), size - static_cast<off_t>(text.size()));
  text.resize(got > 0 ? static_cast<size_t>(got) : 0);
  const size_t last = text.find_last_not_of(" \r\n\t");
  text.resize(last == std::string::npos ? 0 : last + 1);
  return text;
}

}  // namespace robocell::internal
