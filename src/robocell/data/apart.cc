#include "robocell/data/apart.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>

#include "robocell/base/error.h"
#include "robocell/data/hdf5.h"

namespace robocell {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kAnswered = 'A';
constexpr char kThrew = 'T';
constexpr char kSystem = 'S';  // an error of the system; its errno follows as one character

// Never returns.
void Answer(int pipe, const std::function<std::vector<std::string>()>& ask) {
  std::string text(1, kAnswered);
  try {
    for (const std::string& line : ask()) text += line + '\n';
  } catch (const IoError& error) {
    const int code = error.system_error();
    text = code == 0 ? std::string(1, kThrew) : std::string{kSystem, static_cast<char>(code)};
    text += error.what();
  } catch (const std::bad_alloc&) {
    text = std::string{kSystem, ENOMEM} + "there is not enough memory to read it";
  } catch (const std::exception& error) {
    text = kThrew + std::string(error.what());
  }
  for (size_t at = 0; at < text.size();) {
    const ssize_t count = ::write(pipe, text.data() + at, text.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) break;
    at += static_cast<size_t>(count);
  }
  ::_exit(0);  // nothing of this process is its own to close
}

// Until the other end closes; false when that takes too long.
bool ReadAll(int pipe, Clock::time_point until, std::string& text) {
  std::array<char, 4096> block{};
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd ready{.fd = pipe, .events = POLLIN, .revents = 0};
    const int found = left > 0 ? ::poll(&ready, 1, static_cast<int>(left)) : 0;
    if (found < 0 && errno == EINTR) continue;
    if (found <= 0) return false;
    const ssize_t count = ::read(pipe, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    text.append(block.data(), static_cast<size_t>(count));
  }
}

int WaitFor(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return lines;
}

// What a process does to itself is an answer; what others do to it (a kill, as of a machine without
// memory) says nothing of what it read.
[[noreturn]] void ThrowEnded(int signal) {
  const bool own = signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE ||
                   signal == SIGILL;
  const std::string text = fmt::format("reading it ends the process ({})", ::strsignal(signal));
  if (own) throw Error(text);
  throw IoError(text, EINTR);
}

}  // namespace

std::vector<std::string> RunApart(const std::function<std::vector<std::string>()>& ask,
                                  std::chrono::seconds most) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw IoError(fmt::format("cannot make a pipe: {}", std::strerror(errno)), errno);
  const pid_t child = hdf5::Fork();
  if (child == 0) Answer(ends[1], ask);
  const int error = errno;
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw IoError(fmt::format("cannot start a process: {}", std::strerror(error)), error);
  }
  std::string text;
  const bool ended = ReadAll(ends[0], Clock::now() + most, text);
  ::close(ends[0]);
  if (!ended) ::kill(child, SIGKILL);
  const int status = WaitFor(child);
  if (!ended)
    throw IoError(fmt::format("reading it had not ended after {} s", most.count()), ETIMEDOUT);
  if (WIFSIGNALED(status)) ThrowEnded(WTERMSIG(status));
  if (text.size() > 2 && text[0] == kSystem)
    throw IoError(text.substr(2), static_cast<unsigned char>(text[1]));
  if (text.empty() || text[0] != kAnswered) throw Error(text.substr(text.empty() ? 0 : 1));
  return Lines(std::string_view(text).substr(1));
}

}  // namespace robocell
