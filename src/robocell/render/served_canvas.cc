#include "robocell/render/served_canvas.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "robocell_drawing_service";
// Long enough for a machine with far more to do than it can.
constexpr int kStartMs = 60000, kAnswerMs = 120000;

class ServiceDied : public Error {
 public:
  using Error::Error;
};

std::string ProgramPath() {
  Dl_info info;
  std::error_code error;
  if (dladdr(reinterpret_cast<const void*>(&IsServiceWanted), &info) == 0) return "";
  return (fs::weakly_canonical(info.dli_fname, error).parent_path() / kProgram).string();
}

// Starts the service as a process that belongs to nobody: it outlives the one that needed it first.
// Throws Error if the program cannot be run.
void StartService(const std::string& name, const std::string& gl) {
  const std::string program = ProgramPath();
  const std::array<const char*, 4> arguments = {program.c_str(), name.c_str(), gl.c_str(), nullptr};
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw IoError(std::strerror(errno));
  FileHandle read_end(ends[0]), write_end(ends[1]);
  // Between fork and exec only calls that are safe after a fork of many threads.
  const pid_t child = fork();
  if (child < 0) throw IoError(fmt::format("cannot start {}: {}", kProgram, std::strerror(errno)));
  if (child == 0) {
    setsid();
    if (fork() != 0) _exit(0);
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, 0);
    dup2(nothing, 1);
    dup2(nothing, 2);
    const int moved = fcntl(*write_end, F_DUPFD_CLOEXEC, 3);
    dup2(moved, 3);
    fcntl(3, F_SETFD, FD_CLOEXEC);
    close_range(4, ~0U, 0);
    execv(arguments[0], const_cast<char* const*>(arguments.data()));
    const int reason = errno;
    static_cast<void>(!write(3, &reason, sizeof reason));
    _exit(1);
  }
  write_end.Close();
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  int reason = 0;
  ssize_t got = 0;
  while ((got = read(*read_end, &reason, sizeof reason)) < 0 && errno == EINTR) {
  }
  if (got == sizeof reason) {
    throw Error(
        fmt::format("cannot run the drawing service '{}': {}. Unset ROBOCELL_GL_SERVICE to "
                    "draw in each process",
                    program, std::strerror(reason)));
  }
}

}  // namespace

bool IsServiceWanted() {
  const char* value = std::getenv("ROBOCELL_GL_SERVICE");
  return value && std::string_view(value) == "1";
}

bool ServedCanvas::CanDraw(const mjModel* model) { return model->nskin == 0 && model->nflex == 0; }

ServedCanvas::ServedCanvas(GlBackend backend, const GlStyle& style)
    : backend_(backend), style_(style), name_(DrawingServiceName(backend)), owner_(getpid()) {
  WithService([] {});
}

void ServedCanvas::Forget() {
  channel_.reset();
  is_uploaded_ = has_memory_ = false;
}

void ServedCanvas::Connect() {
  std::optional<FileHandle> socket = ConnectToDrawingName(name_);
  if (!socket) StartService(name_, GlBackendName(backend_));
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kStartMs);
  while (!socket) {
    if (std::chrono::steady_clock::now() > end)
      throw Error(fmt::format("the drawing service '{}' does not begin", ProgramPath()));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    socket = ConnectToDrawingName(name_);
  }
  channel_.emplace(std::move(*socket));
  if (channel_->peer() < 0) throw Error("the drawing service belongs to another user");
  const std::string described = Ask({.call = DrawingCall::kDescribe}).text.data();
  if (!description_.empty() && described != description_) {
    throw Error(
        fmt::format("the drawing service drew with '{}' and now draws with '{}', whose images "
                    "differ",
                    description_, described));
  }
  description_ = described;
}

DrawingReply ServedCanvas::Ask(const DrawingRequest& request, int descriptor) {
  std::optional<DrawingReply> reply;
  if (channel_->Send(request, descriptor)) reply = channel_->Receive<DrawingReply>(kAnswerMs);
  if (!reply) throw ServiceDied("the drawing service has ended");
  if (reply->ok == 0) throw Error(reply->text.data());
  return *reply;
}

template <class Action>
void ServedCanvas::WithService(const Action& action) {
  constexpr int kMostRestarts = 3;  // for one picture
  if (std::exchange(owner_, getpid()) != getpid()) {
    Forget();
    memory_.reset();
  }
  for (int restarts = 0;; ++restarts) {
    try {
      if (!channel_) Connect();
      return action();
    } catch (const ServiceDied& error) {
      Forget();
      if (restarts == kMostRestarts)
        throw Error(
            fmt::format("{} {} times with the same picture. Unset ROBOCELL_GL_SERVICE to "
                        "draw in each process",
                        error.what(), restarts + 1));
      LogWarn(fmt::format("{}; another one draws its pictures again", error.what()));
    } catch (...) {
      Forget();
      throw;
    }
  }
}

void ServedCanvas::Upload() {
  if (is_uploaded_) return;
  const std::string bytes = SaveBinaryString(model_);
  const SharedMemory memory(bytes.size());
  std::ranges::copy(std::as_bytes(std::span(bytes)), memory.bytes().begin());
  Ask({.call = DrawingCall::kUpload,
       .multisamples = style_.multisamples,
       .shadow_size = style_.shadow_size,
       .things = style_.things ? 1 : 0},
      memory.descriptor());
  is_uploaded_ = true;
}

void ServedCanvas::SetModel(const mjModel* model) {
  model_ = model;
  is_uploaded_ = false;
  WithService([&] { Upload(); });
}

void ServedCanvas::Paint(const GlPicture& picture) {
  WithService([&] {
    Upload();
    const size_t bytes = BytesOfPicture(picture, picture.scene->maxgeom);
    if (!memory_ || memory_->bytes().size() < bytes) {
      memory_ = std::make_unique<SharedMemory>(bytes);
      has_memory_ = false;
    }
    PutPicture(picture, memory_->bytes());
    Ask({.call = DrawingCall::kPaint}, has_memory_ ? -1 : memory_->descriptor());
    has_memory_ = true;
  });
  TakeImages(memory_->bytes(), picture);
}

}  // namespace robocell::internal
