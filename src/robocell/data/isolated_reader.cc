#include "robocell/data/isolated_reader.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/data/hdf5.h"

namespace robocell::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kAnswered = 'A';
constexpr char kThrew = 'T';
constexpr char kSystem = 'S';  // a system error; its errno follows as one character

// A message is its length and its bytes. Returns false if the other end is closed.
bool Send(int socket, std::string_view text) {
  const uint64_t size = text.size();
  std::string message(reinterpret_cast<const char*>(&size), sizeof size);
  message += text;
  for (size_t at = 0; at < message.size();) {
    const ssize_t count = ::send(socket, message.data() + at, message.size() - at, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += static_cast<size_t>(count);
  }
  return true;
}

// Returns false if the other end closes before.
bool ReceiveBytes(int socket, char* to, size_t size) {
  while (size > 0) {
    const ssize_t count = ::recv(socket, to, size, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    to += count;
    size -= static_cast<size_t>(count);
  }
  return true;
}

bool Receive(int socket, std::string& text) {
  uint64_t size = 0;
  if (!ReceiveBytes(socket, reinterpret_cast<char*>(&size), sizeof size)) return false;
  text.resize(size);
  return ReceiveBytes(socket, text.data(), size);
}

std::string AnswerText(const IsolatedReader::Answer& answer, const std::string& question) {
  std::string text(1, kAnswered);
  try {
    for (const std::string& line : answer(question)) text += line + '\n';
    return text;
  } catch (const IoError& error) {
    const int code = error.system_error();
    text = code == 0 ? std::string(1, kThrew) : std::string{kSystem, static_cast<char>(code)};
    return text + error.what();
  } catch (const std::bad_alloc&) {
    return std::string{kSystem, ENOMEM} + "there is not enough memory to read it";
  } catch (const std::exception& error) {
    return kThrew + std::string(error.what());
  }
}

// A fork has copies of all open files, and keeps them open while it lives: encoders would wait for
// more frames, locks would stay held.
void KeepOnly(int socket) {
  ::dup2(socket, 3);
  ::close_range(4, ~0u, 0);
}

// Serves queries in the child until there are no more, or an answer takes so long that the parent
// no longer waits.
[[noreturn]] void Serve(int socket, const IsolatedReader::Answer& answer,
                        std::chrono::seconds most) {
  KeepOnly(socket);
  std::signal(SIGALRM, SIG_DFL);
  std::string question;
  while (Receive(3, question)) {
    ::alarm(static_cast<unsigned>(2 * most.count()));
    if (!Send(3, AnswerText(answer, question))) break;
    ::alarm(0);
  }
  ::_exit(0);  // no resource of this process is its own to close
}

// Returns false if nothing arrived by then.
bool SomethingComes(int socket, Clock::time_point until) {
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd ready{.fd = socket, .events = POLLIN, .revents = 0};
    const int found = left > 0 ? ::poll(&ready, 1, static_cast<int>(left)) : 0;
    if (found < 0 && errno == EINTR) continue;
    return found > 0;
  }
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

// An end that the process caused itself is an answer; an end from outside (a kill, for example on a
// machine without memory) says nothing about the input.
[[noreturn]] void ThrowEnded(std::optional<int> of_child) {
  if (!of_child) throw IoError("reading it ends the process for an unknown reason", ECHILD);
  const int status = *of_child;
  if (!WIFSIGNALED(status)) throw Error("reading it ends the process");
  const int signal = WTERMSIG(status);
  const bool own = signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE ||
                   signal == SIGILL;
  const std::string text = fmt::format("reading it ends the process ({})", ::strsignal(signal));
  if (own) throw Error(text);
  throw IoError(text, EINTR);
}

std::vector<std::string> LinesOrThrow(const std::string& text) {
  if (text.size() > 2 && text[0] == kSystem)
    throw IoError(text.substr(2), static_cast<unsigned char>(text[1]));
  if (text.empty() || text[0] != kAnswered) throw Error(text.substr(text.empty() ? 0 : 1));
  return Lines(std::string_view(text).substr(1));
}

}  // namespace

IsolatedReader::IsolatedReader(Answer answer, std::chrono::seconds most)
    : answer_(std::move(answer)), most_(most) {}

IsolatedReader::~IsolatedReader() {
  if (child_ > 0) End();
}

void IsolatedReader::Start() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw IoError(fmt::format("cannot make a pipe: {}", std::strerror(errno)), errno);
  const pid_t child = hdf5::Fork();
  const int error = errno;
  if (child == 0) Serve(ends[1], answer_, most_);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw IoError(fmt::format("cannot start a process: {}", std::strerror(error)), error);
  }
  socket_ = ends[0];
  child_ = child;
}

std::optional<int> IsolatedReader::End() {
  // Closing alone is not enough: a process forked meanwhile may have a copy of this end.
  ::shutdown(socket_, SHUT_RDWR);
  ::close(std::exchange(socket_, -1));
  const pid_t child = std::exchange(child_, -1);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return std::nullopt;  // the program ignores its children's ends
  }
  return status;
}

IsolatedReader::Reply IsolatedReader::Exchange(std::string_view question, std::string& text) const {
  if (!Send(socket_, question)) return Reply::kEnded;
  if (!SomethingComes(socket_, Clock::now() + most_)) return Reply::kLate;
  return Receive(socket_, text) ? Reply::kWhole : Reply::kEnded;
}

std::vector<std::string> IsolatedReader::Ask(const std::string& question) {
  bool fresh = child_ < 0;
  if (fresh) Start();
  std::string text;
  Reply reply = Exchange(question, text);
  if (reply == Reply::kEnded && !fresh) {
    // An earlier query may have damaged it: a crash must not be blamed on another input.
    End();
    Start();
    reply = Exchange(question, text);
  }
  if (reply == Reply::kWhole) return LinesOrThrow(text);
  if (reply == Reply::kLate) ::kill(child_, SIGKILL);
  const std::optional<int> status = End();
  if (reply == Reply::kEnded) ThrowEnded(status);
  throw IoError(fmt::format("reading it had not ended after {} s", most_.count()), ETIMEDOUT);
}

}  // namespace robocell::internal
