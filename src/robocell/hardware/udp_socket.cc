#include "robocell/hardware/udp_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <system_error>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

sockaddr* Plain(sockaddr_in& address) { return reinterpret_cast<sockaddr*>(&address); }

std::string Why(int error) { return std::generic_category().message(error); }

}  // namespace

sockaddr_in ParseAddress(const std::string& address) {
  sockaddr_in parsed{};
  parsed.sin_family = AF_INET;
  const size_t colon = address.rfind(':');
  const std::string host = address.substr(0, colon);
  uint16_t port = 0;
  const char* end = address.data() + address.size();
  const char* begin = colon == std::string::npos ? end : address.data() + colon + 1;
  const std::from_chars_result read = std::from_chars(begin, end, port);
  const bool has_port = begin != end && read.ec == std::errc() && read.ptr == end;
  if (!has_port || inet_pton(AF_INET, host.c_str(), &parsed.sin_addr) != 1) {
    throw ArgumentError(fmt::format(
        "'{}' is no address of an arm: expected four numbers and a port, such as 127.0.0.1:7071",
        address));
  }
  parsed.sin_port = htons(port);
  return parsed;
}

std::string ToString(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return fmt::format("{}:{}", text.data(), ntohs(address.sin_port));
}

bool IsLoopback(const sockaddr_in& address) {
  return (ntohl(address.sin_addr.s_addr) >> 24U) == 127;
}

bool IsSame(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

UdpSocket::UdpSocket(const sockaddr_in& address)
    : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (socket_ < 0) {
    const int error = errno;
    throw IoError(fmt::format("cannot make a socket: {}", Why(error)), error);
  }
  sockaddr_in own = address;
  if (bind(socket_, Plain(own), sizeof own) == 0) return;
  const int error = errno;
  close(socket_);
  throw IoError(fmt::format("cannot listen at {}: {}", ToString(address), Why(error)), error);
}

UdpSocket::~UdpSocket() { close(socket_); }

sockaddr_in UdpSocket::address() const {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  getsockname(socket_, Plain(own), &size);
  return own;
}

void UdpSocket::Send(std::span<const std::byte> bytes, const sockaddr_in& to) {
  sockaddr_in there = to;
  // An error here is of a peer that is gone or of a full queue: the watch-dogs of both sides notice.
  (void)sendto(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL, Plain(there),
               sizeof there);
}

std::span<const std::byte> UdpSocket::Receive(std::span<std::byte> room, sockaddr_in& from) {
  socklen_t size = sizeof from;
  for (int tries = 0; tries < 4; ++tries) {  // errors of what was sent before come first
    const ssize_t got =
        recvfrom(socket_, room.data(), room.size(), MSG_DONTWAIT, Plain(from), &size);
    if (got >= 0) return room.first(static_cast<size_t>(got));
    if (errno == EAGAIN || errno == EWOULDBLOCK) break;
  }
  return {};
}

}  // namespace robocell::internal
