#include "robocell/media/warm_program.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/real_file.h"
#include "robocell/media/child_process.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPreload = "robocell_warm_start.so";
// Long enough for a disk that was asleep and a machine with far more to do than it can.
constexpr int kLoadMs = 60000;
constexpr int kForkMs = 60000;
// Room for the arguments of each start, which /proc/PID/cmdline shows.
constexpr size_t kShownBytes = 4096;

// Returns the path of the library to preload, beside this one; "" if it is not there or the loader
// could not take its path.
std::string PreloadPath() {
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&StartWarm), &info) == 0) return "";
  std::error_code error;
  const fs::path path = fs::weakly_canonical(info.dli_fname, error).parent_path() / kPreload;
  if (error || !fs::exists(path, error)) return "";
  return path.string().find_first_of(": ") == std::string::npos ? path.string() : "";
}

// Scripts are run by another program, which would be the one that waits.
bool IsBinary(const std::string& program) {
  std::array<char, 4> begin = {};
  std::ifstream(program, std::ios::binary).read(begin.data(), begin.size());
  return std::memcmp(begin.data(), "\177ELF", 4) == 0;
}

// Returns everything else that a start takes from this process, as bytes to compare.
std::string Surroundings() {
  std::string text;
  for (char** variable = environ; *variable; ++variable) text.append(*variable) += '\0';
  const auto add = [&](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int limit = 0; limit < RLIM_NLIMITS; ++limit) {
    rlimit value = {};
    getrlimit(static_cast<__rlimit_resource_t>(limit), &value);
    add(value);
  }
  cpu_set_t processors;
  CPU_ZERO(&processors);
  sched_getaffinity(0, sizeof processors, &processors);
  add(processors);
  add(getpriority(PRIO_PROCESS, 0));
  add(std::array{getuid(), geteuid()});
  add(std::array{getgid(), getegid()});
  return text;
}

// No answer in time, which says nothing about the program.
class TooSlow : public IoError {
 public:
  using IoError::IoError;
};

// Returns nothing at the end of the socket. Throws TooSlow if nothing comes in time.
std::optional<int32_t> ReceiveNumber(int socket, int timeout_ms) {
  pollfd entry{socket, POLLIN, 0};
  int ready = 0;
  while ((ready = poll(&entry, 1, timeout_ms)) < 0 && errno == EINTR) {
  }
  if (ready == 0) throw TooSlow("it does not answer");
  int32_t number = 0;
  if (ready < 0 || recv(socket, &number, sizeof number, MSG_WAITALL) != sizeof number)
    return std::nullopt;
  return number;
}

// Sends the length, with the descriptors, and the arguments. Returns false if nobody receives them.
bool SendRequest(int socket, const std::string& arguments, std::array<int, 5> descriptors) {
  auto size = static_cast<uint32_t>(arguments.size());
  iovec head{&size, sizeof size};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof descriptors)> control = {};
  msghdr message = {};
  message.msg_iov = &head;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* rights = CMSG_FIRSTHDR(&message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  rights->cmsg_len = CMSG_LEN(sizeof descriptors);
  std::memcpy(CMSG_DATA(rights), descriptors.data(), sizeof descriptors);
  if (sendmsg(socket, &message, MSG_NOSIGNAL) != sizeof size) return false;
  const auto length = static_cast<ssize_t>(arguments.size());
  return send(socket, arguments.data(), arguments.size(), MSG_NOSIGNAL) == length;
}

// A program that waits before its main function.
class WarmProgram {
 public:
  // Throws IoError if it does not wait.
  WarmProgram(const std::string& program, const std::string& preload)
      : process_({program, "-hide_banner", "-version", std::string(kShownBytes, ' ')},
                 {.pipe_stdin = true, .environment = {"LD_PRELOAD=" + WithOthers(preload)}}) {
    const std::optional<int32_t> ready = ReceiveNumber(process_.stdin_descriptor(), kLoadMs);
    if (ready == 1) return;
    throw IoError(ready ? "it has threads before its main function"
                        : "it does not wait before its main function");
  }

  // Lets it end by itself: one of another user may not be killed.
  ~WarmProgram() { process_.CloseStdin(); }
  WarmProgram(const WarmProgram&) = delete;
  WarmProgram& operator=(const WarmProgram&) = delete;

  pid_t pid() const { return process_.pid(); }

  // Returns the new process; nothing if this one has ended or does not answer. Throws IoError if it
  // answers that it cannot fork.
  std::optional<pid_t> Start(const std::string& arguments, const ChildDescriptors& child) {
    const Descriptor folder(open(".", O_PATH | O_DIRECTORY | O_CLOEXEC));
    int ends[2] = {-1, -1};
    const bool is_connected = socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0;
    Descriptor go_out(ends[0]);
    const Descriptor go_in(ends[1]);
    if (!folder || !is_connected) throw IoError(std::strerror(errno));
    const int socket = process_.stdin_descriptor();
    if (!SendRequest(socket, arguments, {child.in, child.out, child.errors, *folder, *go_out}))
      return std::nullopt;
    go_out.Close();
    const std::optional<int32_t> answer = AnswerTo(socket);
    if (!answer) return std::nullopt;
    if (*answer <= 0) throw IoError(fmt::format("it cannot fork: {}", std::strerror(-*answer)));
    // The child does so too: whichever comes first, the group exists before anyone sees the child.
    setpgid(*answer, *answer);
    while (send(*go_in, "", 1, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    }
    return *answer;
  }

 private:
  // A descriptor that is closed at the end.
  class Descriptor {
   public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { Close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    explicit operator bool() const { return fd_ >= 0; }
    int operator*() const { return fd_; }
    void Close() {
      if (fd_ >= 0) close(fd_);
      fd_ = -1;
    }

   private:
    int fd_;
  };

  static std::optional<int32_t> AnswerTo(int socket) {
    try {
      return ReceiveNumber(socket, kForkMs);
    } catch (const TooSlow&) {
      return std::nullopt;
    }
  }
  static std::string WithOthers(const std::string& preload) {
    const char* others = std::getenv("LD_PRELOAD");
    return others && *others ? preload + ":" + others : preload;
  }

  ChildProcess process_;
};

class WarmPrograms {
 public:
  explicit WarmPrograms(const WarmPrograms* of_parent) : of_parent_(of_parent) {}

  // Returns that of this process. A process that was forked gets its own, as the lock of the one it
  // has copied may be held for ever. It keeps the copy and never uses it: destroying the copy would
  // need the lock.
  static WarmPrograms& Mine() {
    static std::atomic<WarmPrograms*> mine{nullptr};
    WarmPrograms* now = mine.load(std::memory_order_acquire);
    while (!now || now->owner_ != getpid()) {
      auto* fresh = new WarmPrograms(now);
      if (mine.compare_exchange_strong(now, fresh)) return *fresh;
      delete fresh;
    }
    return *now;
  }

  pid_t Start(const std::vector<std::string>& arguments, const ChildDescriptors& descriptors) {
    std::string text, why_not;
    for (const std::string& argument : arguments) text.append(argument) += '\0';
    const pid_t child = Start(arguments.front(), text, descriptors, why_not);
    // A sink of the log may wait for a thread that waits for the lock.
    if (!why_not.empty()) LogDebug(why_not);
    return child;
  }

  void End() {
    const std::lock_guard lock(mutex_);
    program_.reset();
  }
  pid_t pid() {
    const std::lock_guard lock(mutex_);
    return program_ ? program_->pid() : -1;
  }

 private:
  pid_t Start(const std::string& program, const std::string& arguments,
              const ChildDescriptors& descriptors, std::string& why_not) {
    const std::lock_guard lock(mutex_);
    constexpr int kTries = 2;  // the first one may have ended while it waited
    for (int i = 0; i < kTries; ++i) {
      if (!Ensure(program, why_not)) return -1;
      if (const std::optional<pid_t> child = TryStart(arguments, descriptors, why_not)) {
        failures_ = 0;
        return *child;
      }
      program_.reset();
    }
    return -1;
  }

  // Returns nothing if the process that waits is of no use any more.
  std::optional<pid_t> TryStart(const std::string& arguments, const ChildDescriptors& descriptors,
                                std::string& why_not) {
    try {
      const std::optional<pid_t> child = program_->Start(arguments, descriptors);
      if (!child) ++failures_;
      return child;
    } catch (const IoError& error) {
      ++failures_;
      why_not = fmt::format("no warm start: {}", error.what());
      return std::nullopt;
    }
  }

  bool Ensure(const std::string& program, std::string& why_not) {
    constexpr int kMostFailures = 8;  // in a row: whatever ends it is no accident
    if (failures_ >= kMostFailures) return false;
    const std::string file = FileIdentity(program);
    if (unsuitable_.contains(file)) return false;
    std::string begun_in = file + '\0' + Surroundings();
    if (program_ && begun_in == begun_in_) return true;
    program_.reset();
    try {
      if (!IsBinary(program)) throw IoError("it is a script");
      const std::string preload = PreloadPath();
      if (preload.empty()) throw IoError(fmt::format("there is no {}", kPreload));
      program_ = std::make_unique<WarmProgram>(program, preload);
    } catch (const TooSlow&) {
      ++failures_;
      return false;  // this time
    } catch (const IoError& error) {
      why_not = fmt::format("'{}' is loaded anew for each start: {}", program, error.what());
      unsuitable_.insert(file);
      return false;
    }
    begun_in_ = std::move(begun_in);
    return true;
  }

  pid_t owner_ = getpid();
  // Kept reachable, so that a check for leaks does not count the copy as lost.
  [[maybe_unused]] const WarmPrograms* of_parent_;
  std::mutex mutex_;
  std::unique_ptr<WarmProgram> program_;
  std::string begun_in_;              // the file and surroundings of program_
  std::set<std::string> unsuitable_;  // files
  int failures_ = 0;                  // in a row, of processes that had waited or were too slow
};

bool IsWanted() {
  const char* value = std::getenv("ROBOCELL_WARM_FFMPEG");
  return !value || std::strcmp(value, "0") != 0;
}

}  // namespace

pid_t StartWarm(const std::vector<std::string>& arguments, const ChildDescriptors& descriptors) {
  return IsWanted() ? WarmPrograms::Mine().Start(arguments, descriptors) : -1;
}

void EndWarmPrograms() { WarmPrograms::Mine().End(); }

pid_t WarmProgramPid() { return WarmPrograms::Mine().pid(); }

}  // namespace robocell::internal
