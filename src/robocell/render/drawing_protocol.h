// How a process and the drawing service talk (drawing_service.h, served_canvas.h): requests and
// replies over a socket, scenes and images in memory that both map. One client has one request at a
// time. Internal to render/.
//
//   SharedMemory memory(BytesOfPicture(picture, geoms));      // the client
//   PutPicture(picture, memory.bytes());
//   channel.Send(request, memory.descriptor());
//   GlPicture picture = received.Get(memory.bytes());        // the service, which draws into it
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/render/gl_context.h"
#include "robocell/render/gl_painter.h"

namespace robocell::internal {

// A file descriptor that is closed at the end.
class FileHandle {
 public:
  explicit FileHandle(int descriptor = -1) : descriptor_(descriptor) {}
  ~FileHandle() { Close(); }
  FileHandle(FileHandle&& other) noexcept : descriptor_(other.Release()) {}
  FileHandle& operator=(FileHandle&& other) noexcept;
  explicit operator bool() const { return descriptor_ >= 0; }
  int operator*() const { return descriptor_; }
  void Close() noexcept;
  int Release() noexcept;

 private:
  int descriptor_;
};

// Memory that two processes map. Its size never changes.
class SharedMemory {
 public:
  // Makes a new one. Throws IoError.
  explicit SharedMemory(size_t bytes);
  // Maps that of another process. Throws IoError if its size could change.
  explicit SharedMemory(FileHandle descriptor);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  std::span<std::byte> bytes() const { return bytes_; }
  int descriptor() const { return *descriptor_; }

 private:
  void Map(size_t bytes);

  FileHandle descriptor_;
  std::span<std::byte> bytes_;
};

enum class DrawingCall : int32_t { kDescribe, kUpload, kPaint };

struct DrawingRequest {
  DrawingCall call = DrawingCall::kDescribe;
  int32_t multisamples = 0, shadow_size = 0, things = 1;  // of kUpload
};

// `text` is the answer or, unless ok, the reason.
struct DrawingReply {
  int32_t ok = 0;
  std::array<char, 2044> text = {};

  static DrawingReply Of(bool ok, const std::string& text);
};

// One end of a connection; messages keep their borders.
class DrawingChannel {
 public:
  explicit DrawingChannel(FileHandle socket) : socket_(std::move(socket)) {}

  // Returns false if the other side has gone.
  template <class Message>
  bool Send(const Message& message, int descriptor = -1) const {
    return Send(std::as_bytes(std::span(&message, 1)), descriptor);
  }
  // Returns nothing if the other side has gone, sends something else or is silent for
  // `timeout_ms`. `descriptor` receives what came along.
  template <class Message>
  std::optional<Message> Receive(int timeout_ms, FileHandle* descriptor = nullptr) const {
    Message message;
    if (!Receive(std::as_writable_bytes(std::span(&message, 1)), timeout_ms, descriptor))
      return std::nullopt;
    return message;
  }
  int socket() const { return *socket_; }
  // Returns the process at the other end; -1 if it belongs to another user.
  int peer() const;

 private:
  bool Send(std::span<const std::byte> message, int descriptor) const;
  bool Receive(std::span<std::byte> message, int timeout_ms, FileHandle* descriptor) const;

  FileHandle socket_;
};

// Returns the name of the service that a process with this environment uses: one for each user,
// library and choice of a device.
std::string DrawingServiceName(GlBackend backend);
// Returns a socket with the name of a service: for the service, which takes the name, or connected
// to it. Nothing if the name is taken, or nobody has it. Throws IoError.
std::optional<FileHandle> TakeDrawingName(const std::string& name);
std::optional<FileHandle> ConnectToDrawingName(const std::string& name);

// Returns the bytes of memory for a picture whose list has up to `geoms` elements.
size_t BytesOfPicture(const GlPicture& picture, int geoms);
// Writes the list and the sizes of a picture. `memory` has at least the bytes of it.
void PutPicture(const GlPicture& picture, std::span<std::byte> memory);
// Copies the images that the service has drawn.
void TakeImages(std::span<const std::byte> memory, const GlPicture& picture);

// A picture as the service receives it.
class ReceivedPicture {
 public:
  // Returns a picture whose images are in `memory`; valid until the next call. Throws ArgumentError
  // if the memory is no picture.
  GlPicture Get(std::span<std::byte> memory);

 private:
  mjvScene scene_ = {};
  std::vector<mjvGeom> geoms_;
  std::vector<int> order_;
};

}  // namespace robocell::internal
