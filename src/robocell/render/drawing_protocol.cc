#include "robocell/render/drawing_protocol.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <type_traits>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/real_file.h"
#include "robocell/render/egl_devices.h"
#include "robocell/render/graphics_advice.h"
#include "robocell/render/renderer.h"

namespace robocell::internal {
namespace {

[[noreturn]] void ThrowSystem(const std::string& what) {
  throw IoError(fmt::format("drawing service: {}: {}", what, std::strerror(errno)));
}

// The beginning of a picture's memory.
struct Frame {
  int32_t width = 0, height = 0, geoms = 0, exact_geoms = 0, lights_used = 0;
  bool has_rgb = false, has_codes = false, has_depth = false;
  std::array<mjvLight, mjMAXLIGHT> lights = {};
  std::array<mjvGLCamera, 2> cameras = {};
  std::array<mjtByte, mjNRNDFLAG> flags = {};
};
static_assert(std::is_trivially_copyable_v<Frame>);

struct FramePlaces {
  size_t geoms, rgb, codes, depth, end;
};

FramePlaces PlacesOf(size_t geoms, size_t rgb, size_t codes, size_t depth) {
  const auto after = [](size_t at, size_t bytes) { return (at + bytes + 63) / 64 * 64; };
  FramePlaces places{.geoms = after(0, sizeof(Frame)), .rgb = 0, .codes = 0, .depth = 0, .end = 0};
  places.rgb = after(places.geoms, geoms * sizeof(mjvGeom));
  places.codes = after(places.rgb, rgb);
  places.depth = after(places.codes, codes);
  places.end = after(places.depth, depth);
  return places;
}

FramePlaces PlacesOf(const Frame& frame) {
  const size_t pixels = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  return PlacesOf(static_cast<size_t>(frame.geoms), frame.has_rgb ? 3 * pixels : 0,
                  frame.has_codes ? 3 * pixels : 0, frame.has_depth ? pixels * sizeof(float) : 0);
}

Frame FrameOf(std::span<const std::byte> memory) {
  if (memory.size() < sizeof(Frame)) throw ArgumentError("drawing service: no picture");
  Frame frame;
  std::memcpy(&frame, memory.data(), sizeof frame);
  return frame;
}

// Returns an address among the sockets without a file, which end with their process.
std::pair<sockaddr_un, socklen_t> AddressOf(const std::string& name) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  const size_t length = std::min(name.size(), sizeof address.sun_path - 1);
  std::copy_n(name.begin(), length, address.sun_path + 1);
  return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length)};
}

FileHandle NewSocket() {
  FileHandle made(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (!made) ThrowSystem("no socket");
  return made;
}

const sockaddr* Plain(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW;

}  // namespace

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  if (this != &other) {
    Close();
    descriptor_ = other.Release();
  }
  return *this;
}

void FileHandle::Close() noexcept {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

int FileHandle::Release() noexcept { return std::exchange(descriptor_, -1); }

SharedMemory::SharedMemory(size_t bytes)
    : descriptor_(memfd_create("robocell-picture", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  if (!descriptor_ || ftruncate(*descriptor_, static_cast<off_t>(bytes)) != 0 ||
      fcntl(*descriptor_, F_ADD_SEALS, kSeals) != 0)
    ThrowSystem(fmt::format("no memory of {} bytes to share", bytes));
  Map(bytes);
}

SharedMemory::SharedMemory(FileHandle descriptor) : descriptor_(std::move(descriptor)) {
  struct stat status = {};
  if (!descriptor_ || fstat(*descriptor_, &status) != 0) ThrowSystem("no shared memory");
  if ((fcntl(*descriptor_, F_GET_SEALS) & kSeals) != kSeals)
    throw IoError("drawing service: the shared memory could change its size");
  Map(static_cast<size_t>(status.st_size));
}

void SharedMemory::Map(size_t bytes) {
  void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, *descriptor_, 0);
  if (at == MAP_FAILED) ThrowSystem(fmt::format("cannot map {} bytes", bytes));
  bytes_ = {static_cast<std::byte*>(at), bytes};
}

SharedMemory::~SharedMemory() { munmap(bytes_.data(), bytes_.size()); }

DrawingReply DrawingReply::Of(bool ok, const std::string& text) {
  DrawingReply reply;
  reply.ok = ok ? 1 : 0;
  std::copy_n(text.begin(), std::min(text.size(), reply.text.size() - 1), reply.text.begin());
  return reply;
}

bool DrawingChannel::Send(std::span<const std::byte> message, int descriptor) const {
  iovec part{const_cast<std::byte*>(message.data()), message.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control = {};
  msghdr header = {};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  if (descriptor >= 0) {
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    cmsghdr* rights = CMSG_FIRSTHDR(&header);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(rights), &descriptor, sizeof descriptor);
  }
  ssize_t sent = 0;
  while ((sent = sendmsg(*socket_, &header, MSG_NOSIGNAL)) < 0 && errno == EINTR) {
  }
  return sent == static_cast<ssize_t>(message.size());
}

bool DrawingChannel::Receive(std::span<std::byte> message, int timeout_ms,
                             FileHandle* descriptor) const {
  pollfd entry{*socket_, POLLIN, 0};
  int ready = 0;
  while ((ready = poll(&entry, 1, timeout_ms)) < 0 && errno == EINTR) {
  }
  if (ready <= 0) return false;
  iovec part{message.data(), message.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control = {};
  msghdr header = {};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  ssize_t got = 0;
  while ((got = recvmsg(*socket_, &header, MSG_CMSG_CLOEXEC)) < 0 && errno == EINTR) {
  }
  FileHandle received;
  for (cmsghdr* one = CMSG_FIRSTHDR(&header); one; one = CMSG_NXTHDR(&header, one)) {
    if (one->cmsg_level != SOL_SOCKET || one->cmsg_type != SCM_RIGHTS) continue;
    int number = -1;
    std::memcpy(&number, CMSG_DATA(one), sizeof number);
    received = FileHandle(number);
  }
  if (descriptor) *descriptor = std::move(received);
  return got == static_cast<ssize_t>(message.size()) && !(header.msg_flags & MSG_TRUNC);
}

int DrawingChannel::peer() const {
  ucred credentials = {};
  socklen_t size = sizeof credentials;
  const bool known = getsockopt(*socket_, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0;
  return known && credentials.uid == geteuid() ? credentials.pid : -1;
}

std::string DrawingServiceName(GlBackend backend) {
  Dl_info library;
  const bool known = dladdr(reinterpret_cast<const void*>(&DrawingServiceName), &library) != 0;
  const EglDeviceChoice device = EglDeviceChoice::FromEnvironment();
  const GlBackend chosen = backend == GlBackend::kAuto ? GlBackendFromEnvironment() : backend;
  std::string all = known ? FileIdentity(library.dli_fname) : "";
  const int turn = TurnAmongCards(device, ReadGraphicsFacts().nvidia.size());
  for (const std::string& part : {std::string(GlBackendName(chosen)), device.robocell_device,
                                  device.mujoco_device, device.cuda_visible, std::to_string(turn)})
    all += '\0' + part;
  return fmt::format("robocell-drawing-{}-{}", geteuid(), Fingerprint(all));
}

std::optional<FileHandle> TakeDrawingName(const std::string& name) {
  FileHandle made = NewSocket();
  const auto [address, size] = AddressOf(name);
  if (bind(*made, Plain(address), size) != 0) {
    if (errno == EADDRINUSE) return std::nullopt;
    ThrowSystem("cannot take its name");
  }
  if (listen(*made, SOMAXCONN) != 0) ThrowSystem("cannot be called");
  return made;
}

std::optional<FileHandle> ConnectToDrawingName(const std::string& name) {
  FileHandle made = NewSocket();
  const auto [address, size] = AddressOf(name);
  int result = 0;
  while ((result = connect(*made, Plain(address), size)) != 0 && errno == EINTR) {
  }
  if (result == 0) return made;
  if (errno == ECONNREFUSED || errno == ECONNRESET) return std::nullopt;
  ThrowSystem("cannot connect");
}

size_t BytesOfPicture(const GlPicture& picture, int geoms) {
  return PlacesOf(static_cast<size_t>(geoms), picture.rgb.size(), picture.codes.size(),
                  picture.depth.size_bytes())
      .end;
}

void PutPicture(const GlPicture& picture, std::span<std::byte> memory) {
  const mjvScene& scene = *picture.scene;
  Frame frame{.width = picture.width,
              .height = picture.height,
              .geoms = scene.ngeom,
              .exact_geoms = picture.exact_geoms,
              .lights_used = scene.nlight,
              .has_rgb = !picture.rgb.empty(),
              .has_codes = !picture.codes.empty(),
              .has_depth = !picture.depth.empty()};
  std::ranges::copy(scene.lights, frame.lights.begin());
  std::ranges::copy(scene.camera, frame.cameras.begin());
  std::ranges::copy(scene.flags, frame.flags.begin());
  std::memcpy(memory.data(), &frame, sizeof frame);
  std::memcpy(memory.data() + PlacesOf(frame).geoms, scene.geoms,
              static_cast<size_t>(scene.ngeom) * sizeof(mjvGeom));
}

void TakeImages(std::span<const std::byte> memory, const GlPicture& picture) {
  const FramePlaces places = PlacesOf(FrameOf(memory));
  const auto take = [&](size_t at, auto images) {
    if (!images.empty()) std::memcpy(images.data(), memory.data() + at, images.size_bytes());
  };
  take(places.rgb, picture.rgb);
  take(places.codes, picture.codes);
  take(places.depth, picture.depth);
}

GlPicture ReceivedPicture::Get(std::span<std::byte> memory) {
  const Frame frame = FrameOf(memory);
  constexpr int kMostGeoms = 1 << 22;
  RequireImageSize(frame.width, frame.height);
  const bool is_list = frame.geoms >= 0 && frame.geoms <= kMostGeoms && frame.exact_geoms >= 0 &&
                       frame.exact_geoms <= frame.geoms && frame.lights_used >= 0 &&
                       frame.lights_used <= mjMAXLIGHT;
  if (!is_list || PlacesOf(frame).end > memory.size())
    throw ArgumentError("drawing service: no picture");

  const FramePlaces places = PlacesOf(frame);
  geoms_.resize(static_cast<size_t>(frame.geoms));
  order_.resize(geoms_.size());
  if (!geoms_.empty())
    std::memcpy(geoms_.data(), memory.data() + places.geoms, geoms_.size() * sizeof(mjvGeom));
  mjv_defaultScene(&scene_);
  scene_.scale = scene_.rotate[0] = 1;  // as mjv_makeScene sets them
  scene_.geoms = geoms_.data();
  scene_.geomorder = order_.data();
  scene_.ngeom = scene_.maxgeom = frame.geoms;
  scene_.nlight = frame.lights_used;
  std::ranges::copy(frame.lights, scene_.lights);
  std::ranges::copy(frame.cameras, scene_.camera);
  std::ranges::copy(frame.flags, scene_.flags);

  const size_t pixels = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  std::byte* at = memory.data();
  GlPicture picture{.scene = &scene_,
                    .exact_geoms = frame.exact_geoms,
                    .width = frame.width,
                    .height = frame.height};
  if (frame.has_rgb) picture.rgb = {reinterpret_cast<uint8_t*>(at + places.rgb), 3 * pixels};
  if (frame.has_codes) picture.codes = {reinterpret_cast<uint8_t*>(at + places.codes), 3 * pixels};
  if (frame.has_depth) picture.depth = {reinterpret_cast<float*>(at + places.depth), pixels};
  return picture;
}

}  // namespace robocell::internal
