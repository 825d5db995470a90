#include "robocell/media/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <set>

#include "robocell/base/error.h"
#include "robocell/media/testing/videos.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

std::string Output(ChildProcess& child) {
  std::string text(4096, '\0');
  text.resize(child.Read({reinterpret_cast<uint8_t*>(text.data()), text.size()}));
  return text;
}

std::vector<std::string> Shell(const std::string& script) { return {"/bin/sh", "-c", script}; }

TEST(ChildProcess, PassesBytesThroughPipes) {
  ChildProcess child({"/bin/cat"}, {.pipe_stdin = true, .pipe_stdout = true});
  const std::string text = "frames";
  EXPECT_TRUE(child.Write({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
  child.CloseStdin();
  EXPECT_EQ(Output(child), text);
  EXPECT_EQ(child.Wait(), 0);
  EXPECT_EQ(child.DescribeEnd(), "exited with code 0");
}

TEST(ChildProcess, AForkDoesNotAffectIt) {
  ChildProcess child({"/bin/cat"}, {.pipe_stdin = true, .pipe_stdout = true});
  const pid_t fork_of_ours = fork();
  if (fork_of_ours == 0) {
    child.Kill();
    _exit(0);
  }
  waitpid(fork_of_ours, nullptr, 0);
  const std::string text = "frames";
  EXPECT_TRUE(child.Write({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
  child.CloseStdin();
  EXPECT_EQ(Output(child), text);
  EXPECT_EQ(child.Wait(), 0);
}

TEST(ChildProcess, ItsInputEndsDespiteALiveFork) {
  ChildProcess child({"/bin/cat"}, {.pipe_stdin = true, .stall_timeout_s = 5});
  const pid_t fork_of_ours = fork();
  if (fork_of_ours == 0) {
    pause();
    _exit(0);
  }
  child.CloseStdin();
  EXPECT_EQ(child.Wait(), 0);
  kill(fork_of_ours, SIGKILL);
  waitpid(fork_of_ours, nullptr, 0);
}

TEST(ChildProcess, InheritsNoDescriptors) {
  const int leaked = open("/dev/null", O_RDONLY);  // without O_CLOEXEC, like other libraries
  ChildProcess child(Shell("ls /proc/$$/fd"), {.pipe_stdin = true, .pipe_stdout = true});
  EXPECT_EQ(Output(child), "0\n1\n2\n");
  close(leaked);
}

std::set<int> InheritableDescriptors() {
  std::set<int> inheritable;
  for (int fd = 0; fd < 256; ++fd) {
    const int flags = fcntl(fd, F_GETFD);
    if (flags >= 0 && (flags & FD_CLOEXEC) == 0) inheritable.insert(fd);
  }
  return inheritable;
}

TEST(ChildProcess, PipeEndsAreNotInheritedByOtherChildren) {
  const std::set<int> before = InheritableDescriptors();
  ChildProcess child({"/bin/cat"}, {.pipe_stdin = true, .pipe_stdout = true});
  EXPECT_EQ(InheritableDescriptors(), before);
}

TEST(ChildProcess, WritingToADeadChildIsFalseAndRaisesNoSignal) {
  signal(SIGPIPE, SIG_DFL);
  ChildProcess child({"/bin/true"}, {.pipe_stdin = true});
  child.Wait();
  const std::vector<uint8_t> bytes(1 << 20);
  EXPECT_FALSE(child.Write(bytes));
}

TEST(ChildProcess, TheDestructorKillsAndReaps) {
  { ChildProcess child({"/bin/sleep", "100"}, {}); }
  ExpectNoChildLeft();
}

TEST(ChildProcess, AStalledChildIsStoppedAndNamed) {
  ChildProcess child({"/bin/sleep", "100"}, {.pipe_stdin = true, .stall_timeout_s = 0.2});
  const std::vector<uint8_t> bytes(8 << 20);
  ExpectThrow<IoError>([&] { child.Write(bytes); },
                       "'/bin/sleep' made no progress for 0.2 s while we were writing to it");
  ExpectNoChildLeft();
}

TEST(ChildProcess, ReportsItsErrorOutputAndExitCode) {
  ChildProcess child(Shell("echo no space left >&2; exit 3"), {});
  EXPECT_EQ(child.Wait(), 3);
  EXPECT_EQ(child.Errors(), "no space left");
  ChildProcess killed(Shell("kill -9 $$"), {});
  EXPECT_EQ(killed.Wait(), 128 + 9);
  EXPECT_EQ(killed.DescribeEnd(), "was killed by signal 9 (Killed)");
}

TEST(ChildProcess, AMissingProgramIsNamed) {
  ExpectThrow<IoError>([] { ChildProcess child({"/no/such/program"}, {}); },
                       "cannot start '/no/such/program': No such file or directory");
}

TEST(ChildProcess, CtrlCInTheTerminalDoesNotReachIt) {
  ChildProcess child({"/bin/sleep", "100"}, {});
  EXPECT_EQ(getpgid(child.pid()), child.pid());
  EXPECT_NE(getpgid(child.pid()), getpgrp());
}

// Returns the signals 1 ... 31 of a line of /proc/PID/status; the C library keeps 32 and 33 for
// itself.
uint64_t StandardSignals(const std::string& status, const std::string& line) {
  const size_t at = status.find(line + ":\t");
  return at == std::string::npos ? ~0u
                                 : std::stoull(status.substr(at + 8), nullptr, 16) & 0x7fffffff;
}

TEST(ChildProcess, StartsWithDefaultSignals) {
  const auto handler = signal(SIGPIPE, SIG_IGN);
  sigset_t mine;
  sigset_t before;
  sigfillset(&mine);
  sigprocmask(SIG_SETMASK, &mine, &before);
  ChildProcess child({"/bin/cat", "/proc/self/status"}, {.pipe_stdout = true});
  const std::string status = Output(child);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  signal(SIGPIPE, handler);
  EXPECT_EQ(StandardSignals(status, "SigBlk"), 0);
  EXPECT_EQ(StandardSignals(status, "SigIgn"), 0);
}

}  // namespace
}  // namespace robocell::internal
